/* SPDX-License-Identifier: MIT */
/*
 * What --version says of the libraries: those that run now, which need not be those of the build.
 */
#ifndef RB_APP_LIBRARIES_H
#define RB_APP_LIBRARIES_H

#include <stdio.h>

/*
 * One line for the program and for each of its modules, which are loaded for it; why, where one
 * can't be.
 */
void rb_libraries_print(FILE *out);

#endif
