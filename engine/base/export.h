/* SPDX-License-Identifier: GPL-3.0-or-later */
/** The mark of an exported symbol: everything else is hidden by the build. */
#ifndef STRUT_ENGINE_BASE_EXPORT_H
#define STRUT_ENGINE_BASE_EXPORT_H

#define STRUT_API __attribute__((visibility("default")))

#endif
