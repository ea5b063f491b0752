/* SPDX-License-Identifier: MIT */
#include "flow/run_info.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/clock.h"

void rb_run_info_init(struct rb_run_info *info, struct rb_run_texts *texts,
                      const struct rb_model *model)
{
	const char *const author = getenv("USER");

	*texts = (struct rb_run_texts){0};
	if (gethostname(texts->host, sizeof texts->host - 1) != 0)
		snprintf(texts->host, sizeof texts->host, "unknown");
	*info = (struct rb_run_info){
		.host = texts->host,
		.author = author && *author ? author : "unknown",
		.method = rb_model_method(model),
		.rollback = rb_rollback_name(model->rollback),
		.model = model,
		.scene = model->scene,
	};
	rb_clock_utc(info->started);
}
