/* SPDX-License-Identifier: MIT */
/* What rb_module_hdf5 looks up in rbsim-hdf5.so. */
#ifndef RB_SINK_H5MODULE_H
#define RB_SINK_H5MODULE_H

#include "sink/module.h"

extern const struct rb_hdf5_module rb_hdf5_module;

#endif
