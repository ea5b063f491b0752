/* SPDX-License-Identifier: MIT */
/* stepped/pack_kernel in numbers of 64 bits. */
#define SINGLE 0
#include "stepped/pack_kernel.h"

const struct rb_pack_kernel rb_pack_double = KERNEL;
