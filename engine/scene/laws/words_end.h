/* SPDX-License-Identifier: GPL-3.0-or-later */
/** Ends the text of a law; see laws/words.h. */
#undef real
#undef mask
#undef all
#undef less
#undef at_least
#undef both
#undef either
#undef some
#undef choose
#undef keep
#undef add_where
#undef magnitude
#undef root
#undef whole
#undef against
#ifdef LAW_OF_DOUBLES
#undef LAW
#undef LAW_INLINE
#undef LAW_OF_DOUBLES
#endif
