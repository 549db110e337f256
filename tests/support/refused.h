/* SPDX-License-Identifier: GPL-3.0-or-later */
/**
 * Memory that is refused once: refused(n, call) is the status of the call when the allocation after n good
 * ones fails, STRUT_OK or STRUT_NO_MEMORY; anything else fails the test.
 */
#ifndef STRUT_TESTS_SUPPORT_REFUSED_H
#define STRUT_TESTS_SUPPORT_REFUSED_H

#include "engine/base/memory.h"
#include "engine/base/status.h"
#include "tests/support/test.h"

#define refused(n, call) (strut_fail_allocation_after(n), granted_again(call))

static inline strut_status granted_again(strut_status status) {
  strut_fail_allocation_after(-1);
  if (status != STRUT_OK) assert_int_equal(status, STRUT_NO_MEMORY);
  return status;
}

#endif
