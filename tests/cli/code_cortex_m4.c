/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a Cortex-M4 with an FPU does before newlib's start: the vector table, and the FPU switched on. */
#include <stdint.h>

void _start(void);
static void reset(void);

__attribute__((section(".vectors"), used)) static const struct {
  uintptr_t stack;
  void (*reset)(void);
} vectors = {0x20100000u, reset};

static void reset(void) {
  *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20;
  __asm__ volatile("dsb\n\tisb");
  _start();
}
