/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * How much of a tensegrity a structure is, by a published definition.
 *
 * Obara, Klosowska, Gilewski, "Truth and Myths about 2D Tensegrity Trusses", Appl. Sci. 9 (2019)
 * 179; in the words of Obara, Tomasik, Appl. Sci. 10 (2020) 7042: S a state of self-stress, C
 * cables pull, M an infinitesimal mechanism stiffened by self-stress, D struts that do not touch,
 * I struts within one net of what is pulled. Ideal tensegrity: all of them, with every state; pure:
 * all but I; features of class 1: S, C, M with some state; of class 2: S, C and one of I and D.
 */
#ifndef STRUT_ENGINE_STATICS_RIGIDITY_TENSEGRITY_H
#define STRUT_ENGINE_STATICS_RIGIDITY_TENSEGRITY_H

#include "engine/statics/rigidity/rigidity.h"

/**
 * Fills in rigidity->tensegrity from all else in it; q (length) is the shape. STRUT_OK or
 * STRUT_NO_MEMORY.
 */
strut_status strut_tensegrity_judge(const strut_model *model, const double *q,
                                    strut_rigidity *rigidity);

#endif
