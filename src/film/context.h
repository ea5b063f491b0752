/* SPDX-License-Identifier: MIT */
/*
 * An OpenGL context without a window, on Mesa's software rasteriser: the same pictures wherever
 * they are drawn.
 *
 * Two ways lead there, each a source file of its own, and a build has one of them (GL=osmesa or
 * GL=egl): the OSMesa library, and EGL, which Mesa has kept. Belongs to one thread; several may
 * take turns there.
 */
#ifndef RB_FILM_CONTEXT_H
#define RB_FILM_CONTEXT_H

#include "base/error.h"

struct rb_context;

/* Current afterwards. RB_ERR_MISSING without OpenGL 3.3 core; RB_ERR_MEMORY. */
RB_CHECKED enum rb_status rb_context_create(struct rb_context **context, struct rb_error *err);
/* NULL is fine. Takes all that was made in it along. */
void rb_context_destroy(struct rb_context *context);
/* To be called before any OpenGL call that is meant for this context. */
RB_CHECKED enum rb_status rb_context_enter(struct rb_context *context, struct rb_error *err);

/* A function newer than those that the library exports by name; NULL: it has none. */
typedef void (*rb_context_function)(void);
rb_context_function rb_context_find(const char *name);

#endif
