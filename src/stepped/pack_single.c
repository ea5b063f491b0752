/* SPDX-License-Identifier: MIT */
/* stepped/pack_kernel in numbers of 32 bits. */
#define SINGLE 1
#include "stepped/pack_kernel.h"

const struct rb_pack_kernel rb_pack_single = KERNEL;
