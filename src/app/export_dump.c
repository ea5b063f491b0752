/* SPDX-License-Identifier: MIT */
/*
 * A text dump as LAMMPS writes it (dump custom), for OVITO and what else reads these: every body of
 * a volume, static ones too, in every frame. Names of columns are those that OVITO maps by itself:
 * orientation quat*, Cartesian half-axes shape* (of what is no sphere: of the box round it), radius
 * (of what is no sphere 0). id counts from 1: the body's id + 1; type is its material's number + 1.
 * TIMESTEP is the number of the frame.
 */
#include "app/exported.h"

#include <inttypes.h>

#include "base/error.h"
#include "math/vec3.h"
#include "model/shape.h"

/* Whether a body is an atom of the dump: planes and rectangles are not. */
static bool is_listed(const struct rb_model *model, int index)
{
	return rb_shape_type(&model->shape[index])->form != RB_FORM_SURFACE;
}

static void print_cells(FILE *file, const double *values, int count)
{
	for (int k = 0; k < count; k++) {
		putc(' ', file);
		rb_exported_number(file, values[k]);
	}
}

/* Half-axes of a body: of a hull or union the reach in all directions. */
static rb_vec3 half_axes(const struct rb_model *model, int index)
{
	const struct rb_shape *const shape = &model->shape[index];
	const struct rb_shape_type *const type = rb_shape_type(shape);
	const double reach = rb_model_reach(model, index);

	return type->half ? type->half(shape) : (rb_vec3){reach, reach, reach};
}

static void print_body(const struct rb_exported *exported, FILE *file, const struct rb_frame *frame,
                       int index)
{
	const struct rb_model *const model = exported->loaded.model;
	const bool moves = index < model->body_count,
		   ball = model->shape[index].kind == RB_SHAPE_SPHERE;
	const rb_vec3 x = rb_exported_position(exported, frame, index);
	const rb_quat q = rb_exported_orientation(exported, frame, index);
	const rb_vec3 half = half_axes(model, index);
	const rb_vec3 still = {0};
	const rb_vec3 v = moves && frame->velocity
	                          ? rb_vec3_from(frame->velocity + 3 * (size_t)index)
	                          : still;
	const rb_vec3 w = moves && frame->angular_velocity
	                          ? rb_vec3_from(frame->angular_velocity + 3 * (size_t)index)
	                          : still;

	fprintf(file, "%d %d", model->id_of[index] + 1, model->material[index] + 1);
	print_cells(file,
	            (const double[]){x.x, x.y, x.z, v.x, v.y, v.z, w.x, w.y, w.z,
	                             ball ? model->shape[index].radius : 0, q.x, q.y, q.z, q.w,
	                             half.x, half.y, half.z},
	            17);
	putc('\n', file);
}

static enum rb_status write_dump(struct rb_exported *exported, const char *name,
                                 struct rb_error *err)
{
	const struct rb_model *const model = exported->loaded.model;
	const int total = model->body_count + model->static_count;
	const double box[3][2] = {{exported->box.low.x, exported->box.high.x},
	                          {exported->box.low.y, exported->box.high.y},
	                          {exported->box.low.z, exported->box.high.z}};
	struct rb_outfile out;
	struct rb_frame frame;
	int listed = 0;
	enum rb_status status = rb_exported_begin(exported, &out, name, err);

	if (status)
		return status;
	for (int i = 0; i < total; i++)
		listed += is_listed(model, i);
	for (uint64_t row = 0; row < exported->reading->frame_count && !status; row++) {
		status = exported->module->reader_frame(exported->reader, row, &frame, err);
		if (status)
			break;
		fprintf(out.file,
		        "ITEM: TIMESTEP\n%" PRIu64 "\nITEM: NUMBER OF ATOMS\n%d\n"
		        "ITEM: BOX BOUNDS ff ff ff\n",
		        frame.index, listed);
		for (int k = 0; k < 3; k++) {
			rb_exported_number(out.file, box[k][0]);
			print_cells(out.file, &box[k][1], 1);
			putc('\n', out.file);
		}
		fputs("ITEM: ATOMS id type x y z vx vy vz omegax omegay omegaz radius quati quatj "
		      "quatk quatw shapex shapey shapez\n",
		      out.file);
		for (int i = 0; i < total; i++)
			if (is_listed(model, i))
				print_body(exported, out.file, &frame, i);
	}
	if (!status)
		return rb_exported_publish(
			exported, &out, name,
			&(struct rb_export_content){exported->reading->frame_count, "frame",
		                                    "frames"},
			err);
	rb_outfile_release(&out);
	return status;
}

const struct rb_export_form rb_export_dump = {"dump", ".dump", write_dump, true};
