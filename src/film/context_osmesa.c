/* SPDX-License-Identifier: MIT */
/*
 * The way through OSMesa: the rasteriser as a library, which needs no display, device or driver.
 * Versions are tried from the highest on.
 */
#include "film/context.h"

#ifndef RB_GL_EGL

#include <GL/osmesa.h>

#include "base/memory.h"

struct rb_context {
	OSMesaContext made;
	/* It insists on a picture of its own; nothing is drawn on it. */
	unsigned char own[4 * 4 * 4];
};

enum rb_status rb_context_create(struct rb_context **context_out, struct rb_error *err)
{
	static const int versions[][2] = {{4, 5}, {4, 3}, {4, 1}, {4, 0}, {3, 3}};

	*context_out = NULL;
	struct rb_context *const context = rb_memory_take(1, sizeof *context);
	if (!context)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw: out of memory");
	for (size_t k = 0; k < sizeof versions / sizeof versions[0] && !context->made; k++) {
		const int wanted[] = {OSMESA_FORMAT,
		                      OSMESA_RGBA,
		                      OSMESA_PROFILE,
		                      OSMESA_CORE_PROFILE,
		                      OSMESA_CONTEXT_MAJOR_VERSION,
		                      versions[k][0],
		                      OSMESA_CONTEXT_MINOR_VERSION,
		                      versions[k][1],
		                      0};
		context->made = OSMesaCreateContextAttribs(wanted, NULL);
	}
	const enum rb_status status =
		context->made
			? rb_context_enter(context, err)
			: RB_FAIL(err, RB_ERR_MISSING,
	                          "cannot draw: the OSMesa library has no OpenGL 3.3 core context");
	if (status) {
		rb_context_destroy(context);
		return status;
	}
	*context_out = context;
	return RB_OK;
}

void rb_context_destroy(struct rb_context *context)
{
	if (!context)
		return;
	if (context->made)
		OSMesaDestroyContext(context->made);
	rb_memory_free(context);
}

enum rb_status rb_context_enter(struct rb_context *context, struct rb_error *err)
{
	if (OSMesaGetCurrentContext() == context->made)
		return RB_OK;
	if (!OSMesaMakeCurrent(context->made, context->own, GL_UNSIGNED_BYTE, 4, 4))
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot draw: the OSMesa library does not make its context current");
	return RB_OK;
}

rb_context_function rb_context_find(const char *name)
{
	return OSMesaGetProcAddress(name);
}

#endif
