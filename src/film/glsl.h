/* SPDX-License-Identifier: MIT */
/*
 * Shader programs. What does not compile is a mistake of ours or of the driver: RB_ERR_BUG with its
 * log.
 */
#ifndef RB_FILM_GLSL_H
#define RB_FILM_GLSL_H

#include "film/canvas.h"

/*
 * A program of a vertex and a fragment shader. Each text is put together from parts; `defines`
 * comes first in both, after the version ("#define SHADOWS 1\n" or ""). NULL ends a list of parts.
 * `name` is for messages.
 */
struct rb_glsl_parts {
	const char *name, *defines;
	const char *vertex[4], *fragment[6];
};

RB_CHECKED enum rb_status rb_glsl_program(GLuint *program, const struct rb_glsl_parts *parts,
                                          struct rb_error *err);

/* Of the program in use; a name that the compiler has thrown out is fine. */
GLint rb_glsl_place(GLuint program, const char *name);

#endif
