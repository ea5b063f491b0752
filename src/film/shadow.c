/* SPDX-License-Identifier: MIT */
/*
 * One depth texture for each light that throws shadows, compared by the sampler (sampler2DShadow).
 * Of the texture only the corner that the fit asks for is drawn and read.
 */
#include "film/shadow.h"

#include "base/error.h"

enum { WHOLE = RB_SHADOW_SIDE, MARGIN = 4 };

/* Texture and framebuffer of light k. */
static void make_map(struct rb_shadows *shadows, int k)
{
	glGenTextures(1, &shadows->map[k]);
	glActiveTexture(GL_TEXTURE0 + (GLenum)k);
	glBindTexture(GL_TEXTURE_2D, shadows->map[k]);
	glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, WHOLE, WHOLE, 0, GL_DEPTH_COMPONENT,
	             GL_FLOAT, NULL);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
	shadows->dirty[k] = WHOLE;
}

enum rb_status rb_shadows_make(struct rb_shadows *shadows, const struct rb_lights *lights,
                               struct rb_error *err)
{
	*shadows = (struct rb_shadows){.whole = WHOLE};
	glGenFramebuffers(1, &shadows->target);
	for (int k = 0; k < lights->count; k++)
		if (lights->of[k].shadow)
			make_map(shadows, k);
	return rb_canvas_check("make shadow maps", err);
}

/* Draws the casters into the map. */
static void draw_map(struct rb_shadows *shadows, int k, const struct rb_shadow_fit *fit,
                     struct rb_bodies *bodies)
{
	const int used = fit->side + 2 * MARGIN;
	const int clear = used > shadows->dirty[k] ? used : shadows->dirty[k];

	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadows->map[k],
	                       0);
	glEnable(GL_SCISSOR_TEST);
	glScissor(0, 0, clear, clear);
	glClearDepth(1);
	glClear(GL_DEPTH_BUFFER_BIT);
	shadows->dirty[k] = used;
	if (fit->side > 0) {
		glScissor(MARGIN, MARGIN, fit->side, fit->side);
		glViewport(MARGIN, MARGIN, fit->side, fit->side);
		rb_bodies_throw(bodies, fit);
	}
	glDisable(GL_SCISSOR_TEST);
}

void rb_shadows_draw(struct rb_shadows *shadows, const struct rb_lights *lights,
                     const struct rb_view *view, struct rb_bodies *bodies,
                     struct rb_shader_block *block)
{
	const struct rb_casters casters = rb_bodies_casters(bodies);

	glBindFramebuffer(GL_FRAMEBUFFER, shadows->target);
	glDrawBuffer(GL_NONE);
	glReadBuffer(GL_NONE);
	glEnable(GL_DEPTH_TEST);
	glDepthMask(GL_TRUE);
	glDepthFunc(GL_LEQUAL);
	/* What is nearer to the light than the map reaches still throws its shadow. */
	glEnable(GL_DEPTH_CLAMP);
	for (int k = 0; k < lights->count; k++) {
		struct rb_shadow_fit fit;
		if (!shadows->map[k])
			continue;
		rb_shadow_fit(&fit, &lights->of[k], view, &casters, shadows->whole);
		draw_map(shadows, k, &fit, bodies);
		rb_shadow_tell(&fit, &lights->of[k], view, block->shadow[k]);
		glActiveTexture(GL_TEXTURE0 + (GLenum)k);
		glBindTexture(GL_TEXTURE_2D, shadows->map[k]);
	}
	glDisable(GL_DEPTH_CLAMP);
}
