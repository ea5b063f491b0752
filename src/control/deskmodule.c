/* SPDX-License-Identifier: MIT */
/* The one object that rbsim-console.so exports (sink/module.h). */
#include "control/deskmodule.h"

#include "control/desk.h"
#include "control/screen.h"

const struct rb_console_module rb_console_module = {
	.version = RB_CONSOLE_MODULE_VERSION,
	.run = rb_desk_run,
	.libraries = rb_screen_library,
};
