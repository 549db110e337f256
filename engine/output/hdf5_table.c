/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/hdf5_library.h"

const strut_hdf5_library strut_hdf5_table = {
    .stamp = {STRUT_VERSION, sizeof(strut_hdf5_library)},
#define FUNCTION(name) .name = name,
#define IDENTIFIER(name) .name = &name,
    STRUT_HDF5_FUNCTIONS(FUNCTION) STRUT_HDF5_IDENTIFIERS(IDENTIFIER)
#undef FUNCTION
#undef IDENTIFIER
};
