/* SPDX-License-Identifier: MIT */
/* `rbsim verify`. Main thread. */
#ifndef RB_APP_VERIFY_H
#define RB_APP_VERIFY_H

#include "app/common.h"

int rb_verify_main(const struct rb_options *options);

#endif
