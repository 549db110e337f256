/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a slider of a parameter means: the number and the unit of its text, and the values around it. */

/** Places of a slider: from 0 to STEPS; the value of the file is in the middle. */
export const STEPS = 400;
const DIGITS = 4;
const NUMBER = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*)$/;
const UNIT = /^[A-Za-z%\u00b0\u00b5][A-Za-z0-9%\u00b0\u00b5^/* .-]*$/;

/** {value, unit, whole} of a text such as "10 Hz"; null where it is no number with a unit. */
export function quantityOf(text) {
  const match = NUMBER.exec(text.trim());
  if (!match || (match[2] && !UNIT.test(match[2]))) return null;
  const value = Number(match[1]);
  return { value, unit: match[2], whole: !match[2] && /^\d+$/.test(match[1]) && value >= 2 };
}

/**
 * The scale of a slider: a decade around the value, logarithmic, or from -1 to 1 around zero. number(place) is the
 * text of a number, place(number) the nearest place.
 */
export function scaleOf({ value, whole }) {
  const write = (x) => String(Number(x.toPrecision(DIGITS)));
  const within = (place) => Math.round(Math.min(STEPS, Math.max(0, place)));
  if (value === 0)
    return { number: (place) => write(2 * place / STEPS - 1), place: (x) => within((x + 1) / 2 * STEPS) };
  return {
    number(place) {
      if (place === STEPS / 2) return String(value);
      const x = value * Math.pow(10, place / STEPS - 0.5);
      return whole ? String(Math.max(1, Math.round(x))) : write(x);
    },
    place: (x) => (x / value > 0 ? within((Math.log10(x / value) + 0.5) * STEPS) : 0)
  };
}
