/* SPDX-License-Identifier: MIT */
/* The one object that rbsim-console.so exports. */
#ifndef RB_CONTROL_DESKMODULE_H
#define RB_CONTROL_DESKMODULE_H

#include "sink/module.h"

extern const struct rb_console_module rb_console_module;

#endif
