/* SPDX-License-Identifier: MIT */
/* `rbsim export`. Main thread. */
#ifndef RB_APP_EXPORT_H
#define RB_APP_EXPORT_H

#include "app/common.h"

int rb_export_main(const struct rb_options *options);

#endif
