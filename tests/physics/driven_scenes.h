/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Driven scenes of one coordinate, whose motions are known, with runs that stop when they are steady.
 */
#pragma once

#include "engine/scene/experiment.h"

/** A run of at most so many periods of the first signal, watched for steady motion. */
void driven_watch(strut_setup *setup, double step, double periods, double tolerance);
/** A mass of 1 kg on a spring of natural frequency w [rad/s], pushed along it by sin(2 pi t). */
void driven_oscillator(strut_setup *setup, double w, double zeta);
/**
 * A mass of 1 kg, 0.3 m above the line of two supports 1 m to either side, on two springs of stiffness
 * 500 N/m; it can move up and down only, and is pushed so.
 */
void driven_snap(strut_setup *setup, double damping, double push, double frequency);
