/* SPDX-License-Identifier: MIT */
/*
 * Renders into a framebuffer object with multisampling and an sRGB colour buffer; reading resolves
 * it by a blit. Depth is float with a clip range of [0, 1] where the driver allows: with a reversed
 * projection, precision is then nearly uniform over all distances.
 */
#include "film/canvas.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "film/context.h"

struct rb_canvas {
	struct rb_context *context;
	int width, height, samples;
	bool depth_from_zero;
	float sample_positions[RB_CANVAS_SAMPLES_MAX][2];
	char renderer[160];
	GLuint target, colour, depth; /* drawn on */
	GLuint flat, flat_colour;     /* read from; 0 without samples */
};

/* True if the context has the extension. */
static bool has_extension(const char *name)
{
	GLint count = 0;

	glGetIntegerv(GL_NUM_EXTENSIONS, &count);
	for (GLint k = 0; k < count; k++)
		if (strcmp((const char *)glGetStringi(GL_EXTENSIONS, (GLuint)k), name) == 0)
			return true;
	return false;
}

/*
 * Chooses depths of [0, 1] if glClipControl exists; it is newer than what the library exports by
 * name.
 */
static void choose_depths(struct rb_canvas *canvas)
{
	PFNGLCLIPCONTROLPROC clip_control = NULL;
	const rb_context_function found = rb_context_find("glClipControl");

	if (!found || !has_extension("GL_ARB_clip_control"))
		return;
	memcpy(&clip_control, &found, sizeof clip_control);
	clip_control(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
	canvas->depth_from_zero = glGetError() == GL_NO_ERROR;
}

/*
 * Renderer, limits and number of samples. Mesa's softpipe is refused: it takes minutes for a
 * picture.
 */
static enum rb_status learn(struct rb_canvas *canvas, int samples, struct rb_error *err)
{
	GLint most = 0, side = 0;
	const char *name = (const char *)glGetString(GL_RENDERER);
	const char *version = (const char *)glGetString(GL_VERSION);
	const char *mesa = version ? strstr(version, "Mesa") : NULL;

	snprintf(canvas->renderer, sizeof canvas->renderer, "%s, %s", name ? name : "unknown",
	         mesa      ? mesa
	         : version ? version
	                   : "unknown version");
	if (strstr(canvas->renderer, "softpipe"))
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot draw with 'softpipe': it takes minutes for a picture; "
		               "wanted 'llvmpipe' (unset GALLIUM_DRIVER)");
	glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &side);
	if (canvas->width > side || canvas->height > side)
		return RB_FAIL(err, RB_ERR_SCENE,
		               "cannot draw a picture of %d x %d pixels: more than %d a side",
		               canvas->width, canvas->height, (int)side);
	glGetIntegerv(GL_MAX_SAMPLES, &most);
	canvas->samples = samples < most ? samples : most;
	if (canvas->samples > RB_CANVAS_SAMPLES_MAX)
		canvas->samples = RB_CANVAS_SAMPLES_MAX;
	if (canvas->samples < 2 || !has_extension("GL_ARB_sample_shading"))
		canvas->samples = 0;
	choose_depths(canvas);
	return RB_OK;
}

/* A render buffer. */
static GLuint make_buffer(GLenum format, int samples, int width, int height)
{
	GLuint buffer = 0;

	glGenRenderbuffers(1, &buffer);
	glBindRenderbuffer(GL_RENDERBUFFER, buffer);
	glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
	return buffer;
}

/* RB_OK if the bound framebuffer is complete. */
static enum rb_status complete(const struct rb_canvas *canvas, struct rb_error *err)
{
	const enum rb_status status = rb_canvas_check("make a picture", err);
	if (status != RB_OK)
		return status;
	const GLenum found = glCheckFramebufferStatus(GL_FRAMEBUFFER);
	if (found == GL_FRAMEBUFFER_COMPLETE)
		return RB_OK;
	return RB_FAIL(
		err, RB_ERR_MISSING,
		"cannot draw %d x %d pixels with %d samples on '%s': framebuffer status 0x%x",
		canvas->width, canvas->height, canvas->samples, canvas->renderer, found);
}

/* The multisampled target and, with samples, the one it is resolved to. */
static enum rb_status make_targets(struct rb_canvas *canvas, struct rb_error *err)
{
	const int w = canvas->width, h = canvas->height;
	GLint samples = 0;

	glGenFramebuffers(1, &canvas->target);
	glBindFramebuffer(GL_FRAMEBUFFER, canvas->target);
	canvas->colour = make_buffer(GL_SRGB8_ALPHA8, canvas->samples, w, h);
	canvas->depth = make_buffer(GL_DEPTH_COMPONENT32F, canvas->samples, w, h);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
	                          canvas->colour);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER,
	                          canvas->depth);
	enum rb_status status = complete(canvas, err);
	if (status != RB_OK || canvas->samples == 0)
		return status;
	glGetIntegerv(GL_SAMPLES, &samples);
	canvas->samples = samples < RB_CANVAS_SAMPLES_MAX ? samples : RB_CANVAS_SAMPLES_MAX;
	for (int k = 0; k < canvas->samples; k++)
		glGetMultisamplefv(GL_SAMPLE_POSITION, (GLuint)k, canvas->sample_positions[k]);

	glGenFramebuffers(1, &canvas->flat);
	glBindFramebuffer(GL_FRAMEBUFFER, canvas->flat);
	canvas->flat_colour = make_buffer(GL_SRGB8_ALPHA8, 0, w, h);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER,
	                          canvas->flat_colour);
	return complete(canvas, err);
}

enum rb_status rb_canvas_create(struct rb_canvas **canvas_out, int width, int height, int samples,
                                struct rb_error *err)
{
	*canvas_out = NULL;
	RB_ASSERT(width > 0 && height > 0);
	struct rb_canvas *canvas = rb_memory_take(1, sizeof *canvas);
	if (!canvas)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw: out of memory");
	canvas->width = width;
	canvas->height = height;
	enum rb_status status = rb_context_create(&canvas->context, err);
	if (status == RB_OK)
		status = learn(canvas, samples, err);
	if (status == RB_OK)
		status = make_targets(canvas, err);
	if (status != RB_OK) {
		rb_canvas_destroy(canvas);
		return status;
	}
	*canvas_out = canvas;
	return RB_OK;
}

void rb_canvas_destroy(struct rb_canvas *canvas)
{
	if (!canvas)
		return;
	rb_context_destroy(canvas->context);
	rb_memory_free(canvas);
}

enum rb_status rb_canvas_enter(struct rb_canvas *canvas, struct rb_error *err)
{
	return rb_context_enter(canvas->context, err);
}

void rb_canvas_begin(struct rb_canvas *canvas)
{
	glBindFramebuffer(GL_FRAMEBUFFER, canvas->target);
	glViewport(0, 0, canvas->width, canvas->height);
	glEnable(GL_FRAMEBUFFER_SRGB);
}

enum rb_status rb_canvas_read(struct rb_canvas *canvas, struct rb_pixmap *pixmap,
                              struct rb_error *err)
{
	const int w = canvas->width, h = canvas->height;

	RB_ASSERT(pixmap->width == w && pixmap->height == h);
	glBindFramebuffer(GL_READ_FRAMEBUFFER, canvas->target);
	if (canvas->samples > 0) {
		glBindFramebuffer(GL_DRAW_FRAMEBUFFER, canvas->flat);
		glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
		glBindFramebuffer(GL_READ_FRAMEBUFFER, canvas->flat);
	}
	glPixelStorei(GL_PACK_ALIGNMENT, 4);
	glReadPixels(0, 0, w, h, GL_RGBA, GL_UNSIGNED_BYTE, pixmap->rgba);
	return rb_canvas_check("read a picture", err);
}

int rb_canvas_samples(const struct rb_canvas *canvas)
{
	return canvas->samples;
}

const float (*rb_canvas_sample_positions(const struct rb_canvas *canvas))[2]
{
	return canvas->sample_positions;
}

bool rb_canvas_depth_from_zero(const struct rb_canvas *canvas)
{
	return canvas->depth_from_zero;
}

const char *rb_canvas_renderer(const struct rb_canvas *canvas)
{
	return canvas->renderer;
}

enum rb_status rb_canvas_check(const char *doing, struct rb_error *err)
{
	const GLenum first = glGetError();

	if (first == GL_NO_ERROR)
		return RB_OK;
	/* errors come one for each call; bounded, because a lost context reports errors for ever */
	for (int k = 0; k < 16 && glGetError() != GL_NO_ERROR; k++)
		;
	if (first == GL_OUT_OF_MEMORY)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot %s: OpenGL is out of memory", doing);
	return RB_FAIL(err, RB_ERR_BUG, "cannot %s: OpenGL error 0x%x", doing, first);
}
