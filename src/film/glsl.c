/* SPDX-License-Identifier: MIT */
/*
 * Programs are put together from texts: the version, the defines of this program, and shared parts.
 * Failing to compile is a bug of ours (RB_ERR_BUG), since the texts do not depend on the scene.
 */
#include "film/glsl.h"

#include <string.h>

#include "base/error.h"

enum { PARTS_MAX = 8 };

static const char version[] = "#version 330 core\n"
			      "#extension GL_ARB_sample_shading : enable\n";

/* Keeps the first line of the compiler's log. */
static void cut(char *log)
{
	log[strcspn(log, "\n")] = '\0';
}

/* Compiles the parts of one stage. */
static enum rb_status compile(GLuint *shader, GLenum kind, const struct rb_glsl_parts *parts,
                              struct rb_error *err)
{
	const bool vertex = kind == GL_VERTEX_SHADER;
	const char *text[PARTS_MAX] = {version, parts->defines};
	const char *const *part = vertex ? parts->vertex : parts->fragment;
	const int most = vertex ? 4 : 6;
	int count = 2;
	GLint good = 0;
	char log[160] = "";

	for (int k = 0; k < most && part[k]; k++)
		text[count++] = part[k];
	RB_ASSERT(count <= PARTS_MAX);
	*shader = glCreateShader(kind);
	glShaderSource(*shader, count, text, NULL);
	glCompileShader(*shader);
	glGetShaderiv(*shader, GL_COMPILE_STATUS, &good);
	if (good)
		return RB_OK;
	glGetShaderInfoLog(*shader, sizeof log, NULL, log);
	cut(log);
	return RB_FAIL(err, RB_ERR_BUG, "%s shader '%s' does not compile: %s",
	               vertex ? "vertex" : "fragment", parts->name, log);
}

enum rb_status rb_glsl_program(GLuint *program, const struct rb_glsl_parts *parts,
                               struct rb_error *err)
{
	GLuint vertex = 0, fragment = 0;
	GLint good = 0;
	char log[160] = "";

	*program = 0;
	enum rb_status status = compile(&vertex, GL_VERTEX_SHADER, parts, err);
	if (status == RB_OK)
		status = compile(&fragment, GL_FRAGMENT_SHADER, parts, err);
	if (status == RB_OK) {
		*program = glCreateProgram();
		glAttachShader(*program, vertex);
		glAttachShader(*program, fragment);
		glLinkProgram(*program);
		glGetProgramiv(*program, GL_LINK_STATUS, &good);
		if (!good) {
			glGetProgramInfoLog(*program, sizeof log, NULL, log);
			cut(log);
			glDeleteProgram(*program);
			*program = 0;
			status = RB_FAIL(err, RB_ERR_BUG, "shader '%s' does not link: %s",
			                 parts->name, log);
		}
	}
	glDeleteShader(vertex);
	glDeleteShader(fragment);
	return status;
}

GLint rb_glsl_place(GLuint program, const char *name)
{
	return glGetUniformLocation(program, name);
}
