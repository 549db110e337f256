# SPDX-License-Identifier: GPL-3.0-or-later
# Makes an SVG of Cairo's a third as large, alike to the eye: places to a hundredth of a point, relative
# lines, letters as paths without symbols, halos by reference to their letters, no default attributes.

# The shortest text of a number in hundredths.
function short(hundredths,   text) {
  text = sprintf("%.2f", hundredths / 100)
  sub(/0+$/, "", text)
  sub(/\.$/, "", text)
  sub(/^0\./, ".", text)
  sub(/^-0\./, "-.", text)
  return text == "-0" || text == "" ? "0" : text
}

function hundredths(text,   value) {
  value = 100 * text
  return value < 0 ? -int(0.5 - value) : int(value + 0.5)
}

# Appends a number to a path: a sign parts it from the one before as well as a space does.
function append(text) {
  path = path (path ~ /[0-9.]$/ && text !~ /^-/ ? " " : "") text
}

# The same path, each step from where the last one ended.
function relative(d,   n, i, word, command, k, x, y, px, py, at, startx, starty) {
  n = split(d, word, /[ \t]+/)
  path = ""
  x = y = 0
  for (i = 1; i <= n; ) {
    if (word[i] == "") { i++; continue }
    if (word[i] == "Z") {
      path = path "z"
      x = startx; y = starty
      i++
      continue
    }
    if (word[i] !~ /^[MLC]$/) return d # something unknown: better large than wrong
    command = word[i++]
    at = command == "C" ? 6 : 2
    px = hundredths(word[i]); py = hundredths(word[i + 1])
    if (command == "L" && (px == x) != (py == y)) { # level or upright
      path = path (px == x ? "v" : "h")
      append(px == x ? short(py - y) : short(px - x))
      x = px; y = py
      i += at
      continue
    }
    path = path (command == "M" ? "M" : tolower(command))
    for (k = 0; k < at; k += 2) {
      px = hundredths(word[i + k]); py = hundredths(word[i + k + 1])
      append(short(command == "M" ? px : px - x))
      append(short(command == "M" ? py : py - y))
    }
    x = px; y = py
    if (command == "M") { startx = x; starty = y }
    i += at
  }
  return path
}

# rgb(20%,50%,100%) as #3380ff.
function colours(line,   part, out) {
  out = ""
  while (match(line, /rgb\([0-9.]+%, ?[0-9.]+%, ?[0-9.]+%\)/)) {
    split(substr(line, RSTART + 4, RLENGTH - 5), part, /%, ?/)
    out = out substr(line, 1, RSTART - 1) sprintf("#%02x%02x%02x", part[1] * 2.55 + 0.5, \
                                                  part[2] * 2.55 + 0.5, part[3] * 2.55 + 0.5)
    line = substr(line, RSTART + RLENGTH)
  }
  return out line
}

{
  line = $0
  out = ""
  while (match(line, / (d|x|y)="[^"]*"/)) {
    attribute = substr(line, RSTART + 1, RLENGTH - 2)
    value = attribute
    sub(/^[dxy]="/, "", value)
    name = substr(attribute, 1, 1)
    value = name == "d" ? relative(value) : value ~ /^[-0-9.]+$/ ? short(hundredths(value)) : value
    out = out substr(line, 1, RSTART) name "=\"" value "\""
    line = substr(line, RSTART + RLENGTH)
  }
  line = out line
  gsub(/(fill-opacity|stroke-opacity):1;|stroke-miterlimit:10;|fill-rule:nonzero;/, "", line)
  gsub(/ (fill-opacity|stroke-opacity)="1"| stroke-miterlimit="10"| fill-rule="nonzero"/, "", line)
  # Round ends and corners are said once, for all.
  gsub(/stroke-line(cap|join):round;| stroke-line(cap|join)="round"/, "", line)
  sub(/^<svg /, "<svg stroke-linecap=\"round\" stroke-linejoin=\"round\" ", line)
  gsub(/#glyph/, "#g", line)
  gsub(/id="glyph/, "id=\"g", line)
  sub(/zM[-0-9. ]+"/, "z\"", line) # where Cairo would go on after closing
  if (inside) gsub(/ style="stroke:none;"/, "", line) # letters: an edge comes from whoever uses them
  if (inside && line ~ /^<symbol /) {
    letter = line
    sub(/.* id="/, "", letter)
    sub(/".*/, "", letter)
    next
  }
  if (letter != "" && line ~ /^<\/symbol>/) {
    letter = ""
    next
  }
  if (letter != "") sub(/^<path /, "<path id=\"" letter "\" ", line)
  if (line ~ /<defs>/) inside = 1
  if (line ~ /<\/defs>/) inside = 0
  line = colours(line)
  # The halo of a text is its letters once more, with an edge; the text follows.
  if (halo != "" && line ~ /^<g /) {
    print "<use xlink:href=\"#t" ++texts "\" style=\"" halo "\"/>"
    sub(/^<g /, "<g id=\"t" texts "\" ", line)
    halo = ""
  }
  if (halo != "") print held
  halo = ""
  if (line ~ /^<path .*fill:none;stroke-width:2\.4;.*stroke:#ffffff;.*c/) {
    held = line
    halo = line
    sub(/.*style="fill:none;/, "", halo)
    sub(/".*/, "", halo)
  } else {
    print line
  }
}
END { if (halo != "") print held }
