/* SPDX-License-Identifier: MIT */
/* Where address space is limited (ulimit -v). */
#ifndef RB_BASE_ADDRESS_SPACE_H
#define RB_BASE_ADDRESS_SPACE_H

#include <stdbool.h>
#include <stddef.h>

/*
 * Has threads share one arena of malloc where the limit is below what their own would reserve.
 * Before other threads are started.
 */
void rb_address_space_share_arenas(void);
/* Whether so many more bytes can be had now. */
bool rb_address_space_has(size_t bytes);

#endif
