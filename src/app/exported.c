/* SPDX-License-Identifier: MIT */
#include "app/exported.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/recorded.h"
#include "base/error.h"
#include "math/quat.h"
#include "math/vec3.h"

/* Finds the box round all bodies but planes, over all frames. */
static enum rb_status find_box(struct rb_exported *exported, struct rb_error *err)
{
	const struct rb_model *const model = exported->loaded.model;
	struct rb_frame frame = {0};

	exported->box = rb_trimesh_box_empty();
	for (uint64_t row = 0; row < exported->reading->frame_count; row++) {
		const enum rb_status status = exported->module->reader_frame(exported->reader, row,
		                                                             &frame, err);
		if (status)
			return status;
		for (int i = 0; i < model->body_count; i++)
			rb_trimesh_box_add(&exported->box, model, i,
			                   rb_exported_position(exported, &frame, i));
	}
	rb_trimesh_box_finish(&exported->box, model);
	return RB_OK;
}

enum rb_status rb_exported_open(struct rb_exported *exported, const struct rb_options *options,
                                const struct rb_export_form *form, struct rb_error *err)
{
	*exported = (struct rb_exported){.options = options, .file = options->operand[0]};
	enum rb_status status = rb_recorded_open(&exported->module, &exported->reader,
	                                         exported->file, err);

	if (status)
		return status;
	exported->reading = exported->module->reader_reading(exported->reader);
	if (form->moves && exported->reading->body_count > 0 &&
	    !(exported->reading->fields & RB_FIELD_POSITION))
		return RB_FAIL(err, RB_ERR_INPUT,
		               "'%s' holds no positions ('fields' of record is without "
		               "\"position\"): there is nothing to show",
		               exported->file);
	if (!form->moves)
		return RB_OK;
	status = rb_recorded_load(&exported->loaded, exported->reading, exported->file,
	                          options->trust, err);
	return status ? status : find_box(exported, err);
}

void rb_exported_release(struct rb_exported *exported)
{
	rb_loaded_release(&exported->loaded);
	if (exported->reader)
		exported->module->reader_close(exported->reader);
	*exported = (struct rb_exported){0};
}

enum rb_status rb_exported_begin(const struct rb_exported *exported, struct rb_outfile *out,
                                 const char *name, struct rb_error *err)
{
	if (strlen(name) >= RB_EXPORT_NAME_SIZE)
		return RB_FAIL(err, RB_ERR_CREATE, "the name '%s' is too long", name);
	return rb_outfile_open(out, name, exported->options->force, err);
}

enum rb_status rb_exported_publish(struct rb_exported *exported, struct rb_outfile *out,
                                   const char *name, const struct rb_export_content *content,
                                   struct rb_error *err)
{
	const enum rb_status status = rb_outfile_publish(out, err);

	if (!status && content) {
		RB_ASSERT(exported->output_count < RB_EXPORTS_MAX);
		struct rb_export_output *const output =
			&exported->outputs[exported->output_count++];
		snprintf(output->name, sizeof output->name, "%s", name);
		output->content = *content;
	}
	return status;
}

rb_vec3 rb_exported_position(const struct rb_exported *exported, const struct rb_frame *frame,
                             int index)
{
	const struct rb_model *const model = exported->loaded.model;

	return index < model->body_count && frame->position
	               ? rb_vec3_from(frame->position + 3 * (size_t)index)
	               : model->position[index];
}

rb_quat rb_exported_orientation(const struct rb_exported *exported, const struct rb_frame *frame,
                                int index)
{
	const struct rb_model *const model = exported->loaded.model;

	return index < model->body_count && frame->orientation
	               ? rb_quat_from(frame->orientation + 4 * (size_t)index)
	               : model->orientation[index];
}

struct rb_trimesh_patch rb_exported_patch(const struct rb_exported *exported, int index)
{
	return rb_trimesh_box_patch(&exported->box, exported->loaded.model, index);
}

void rb_exported_number(FILE *file, double value)
{
	char text[40];

	if (isnan(value)) {
		fputs("nan", file); /* without a sign */
		return;
	}
	for (int digits = 15; digits <= 17; digits++) {
		snprintf(text, sizeof text, "%.*g", digits, value);
		if (strtod(text, NULL) == value)
			break;
	}
	fputs(text, file);
}
