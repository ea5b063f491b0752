/* SPDX-License-Identifier: MIT */
/*
 * The way through EGL. The device is Mesa's software rasteriser even where there is a graphics
 * card: cards differ in the last bits of a picture. It is asked for as a device, since the
 * environment (LIBGL_ALWAYS_SOFTWARE) belongs to all threads.
 */
#include "film/context.h"

#ifdef RB_GL_EGL

#include <stdbool.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "base/memory.h"

struct rb_context {
	EGLDisplay display; /* EGL's own: shared, never terminated */
	EGLContext made;
};

enum { DEVICES_MOST = 64 }; /* more graphics devices than any machine has */

/* True if the list of extensions, separated by blanks, has the name. */
static bool has(const char *extensions, const char *name)
{
	const size_t size = strlen(name);

	for (const char *at = extensions; at && (at = strstr(at, name)) != NULL; at += size)
		if ((at == extensions || at[-1] == ' ') && (at[size] == ' ' || !at[size]))
			return true;
	return false;
}

/* Display of Mesa's software device; EGL_NO_DISPLAY: there is none. */
static EGLDisplay software_display(void)
{
	const PFNEGLQUERYDEVICESEXTPROC query_devices = (PFNEGLQUERYDEVICESEXTPROC)
		eglGetProcAddress("eglQueryDevicesEXT");
	const PFNEGLQUERYDEVICESTRINGEXTPROC query_text = (PFNEGLQUERYDEVICESTRINGEXTPROC)
		eglGetProcAddress("eglQueryDeviceStringEXT");
	const PFNEGLGETPLATFORMDISPLAYEXTPROC get_display = (PFNEGLGETPLATFORMDISPLAYEXTPROC)
		eglGetProcAddress("eglGetPlatformDisplayEXT");
	EGLDeviceEXT devices[DEVICES_MOST];
	EGLint count = 0;

	if (!query_devices || !query_text || !get_display ||
	    !query_devices(DEVICES_MOST, devices, &count))
		return EGL_NO_DISPLAY;
	for (EGLint k = 0; k < count; k++)
		if (has(query_text(devices[k], EGL_EXTENSIONS), "EGL_MESA_device_software"))
			return get_display(EGL_PLATFORM_DEVICE_EXT, devices[k], NULL);
	return EGL_NO_DISPLAY;
}

/* Highest version first: a driver gives exactly the version asked for, or none. */
static void make(struct rb_context *context)
{
	static const EGLint versions[][2] = {{4, 5}, {4, 3}, {4, 1}, {4, 0}, {3, 3}};

	for (size_t k = 0; k < sizeof versions / sizeof versions[0] && !context->made; k++) {
		const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION,
		                         versions[k][0],
		                         EGL_CONTEXT_MINOR_VERSION,
		                         versions[k][1],
		                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
		                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
		                         EGL_NONE};
		context->made = eglCreateContext(context->display, EGL_NO_CONFIG_KHR,
		                                 EGL_NO_CONTEXT, wanted);
	}
}

/* Display, context, and current in this thread. */
static enum rb_status set_up(struct rb_context *context, struct rb_error *err)
{
	EGLint major = 0, minor = 0;

	context->display = software_display();
	if (!context->display)
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot draw: EGL knows no software rasteriser (Mesa's is in %s)",
		               "libegl-mesa0");
	if (!eglInitialize(context->display, &major, &minor))
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot draw: EGL does not start its software rasteriser (0x%x)",
		               (unsigned)eglGetError());
	const char *const extensions = eglQueryString(context->display, EGL_EXTENSIONS);
	if (!has(extensions, "EGL_KHR_surfaceless_context") ||
	    !has(extensions, "EGL_KHR_no_config_context"))
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot draw: EGL has no contexts without a window");
	if (eglBindAPI(EGL_OPENGL_API))
		make(context);
	if (!context->made)
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot draw: EGL has no OpenGL 3.3 core context");
	return rb_context_enter(context, err);
}

enum rb_status rb_context_create(struct rb_context **context_out, struct rb_error *err)
{
	*context_out = NULL;
	struct rb_context *const context = rb_memory_take(1, sizeof *context);
	if (!context)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw: out of memory");
	const enum rb_status status = set_up(context, err);
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
	if (context->made) {
		/* what is current lives on */
		if (eglGetCurrentContext() == context->made)
			eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE,
			               EGL_NO_CONTEXT);
		eglDestroyContext(context->display, context->made);
	}
	rb_memory_free(context);
}

enum rb_status rb_context_enter(struct rb_context *context, struct rb_error *err)
{
	/* a thread's own setting, which both calls below go by */
	eglBindAPI(EGL_OPENGL_API);
	if (eglGetCurrentContext() == context->made)
		return RB_OK;
	if (!eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context->made))
		return RB_FAIL(err, RB_ERR_MISSING,
		               "cannot draw: EGL does not make its context current (0x%x)",
		               (unsigned)eglGetError());
	return RB_OK;
}

rb_context_function rb_context_find(const char *name)
{
	return eglGetProcAddress(name);
}

#endif
