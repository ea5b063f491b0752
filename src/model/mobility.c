/* SPDX-License-Identifier: MIT */
/*
 * The rank by Gram and Schmidt, twice for each row: a row whose rest is rounding is redundant.
 * Rows and columns of turning are made comparable to those of translation by a length of the
 * problem, which changes no rank.
 */
#include "model/mobility.h"

#include <math.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "model/center.h"
#include "model/joints.h"

/* A dense matrix of more rows takes seconds. */
enum { ROWS_MAX = 1500 };
/* Share of a row's length that may be rounding: of poses that a scene states with 1e-9 (joints). */
static const double ROUNDING = 1e-8;

static struct rb_pose pose_of(const struct rb_model *model, int index)
{
	struct rb_pose pose = {.origin = model->position[index],
	                       .orientation = model->orientation[index]};

	pose.position = index < model->body_count
	                        ? rb_model_center(model, index, pose.origin, pose.orientation)
	                        : pose.origin;
	return pose;
}

static bool is_free(const struct rb_model *model, int index)
{
	return index >= 0 && index < model->body_count && model->inverse_mass[index] > 0;
}

/* Writes one side of a row: the places of a body's translation and rotation. */
static void put(double *row, const struct rb_model *model, int index, rb_vec3 linear,
                rb_vec3 angular)
{
	if (!is_free(model, index))
		return;
	rb_vec3_to(row + 6 * (size_t)index, linear);
	if (model->features & RB_FEATURE_ROTATION)
		rb_vec3_to(row + 6 * (size_t)index + 3, angular);
}

/* Fills the rows of one joint; how many. */
static int fill(const struct rb_model *model, const struct rb_joint *joint, double *matrix,
                size_t width)
{
	const struct rb_pose a = pose_of(model, joint->a);
	const struct rb_pose b = joint->b >= 0 ? pose_of(model, joint->b) : rb_linkage_world();
	const double length = joint->size > 0 ? joint->size : 1;
	struct rb_linkage_row row[RB_LINKAGE_ROWS_MAX];
	const int count = rb_linkage_rows(&joint->link, &a, &b, row);

	for (int k = 0; k < count; k++) {
		const bool couple = rb_linkage_row_is_couple(&joint->link, k);
		const double scale = couple ? 1 : 1 / length;

		put(matrix + (size_t)k * width, model, joint->a, rb_vec3_neg(row[k].linear),
		    rb_vec3_scale(scale, row[k].angular_a));
		put(matrix + (size_t)k * width, model, joint->b, row[k].linear,
		    rb_vec3_scale(scale, row[k].angular_b));
	}
	return count;
}

static double dot(const double *a, const double *b, size_t width)
{
	double sum = 0;

	for (size_t i = 0; i < width; i++)
		sum += a[i] * b[i];
	return sum;
}

/* Makes the rows orthonormal, one after the other; how many were rounding after that. */
static int reduce(double *matrix, int rows, size_t width)
{
	int rank = 0;

	for (int k = 0; k < rows; k++) {
		double *const row = matrix + (size_t)k * width;
		double *const to = matrix + (size_t)rank * width;
		const double before = sqrt(dot(row, row, width));

		for (int pass = 0; pass < 2; pass++)
			for (int j = 0; j < rank; j++) {
				const double *const base = matrix + (size_t)j * width;
				const double along = dot(base, row, width);

				for (size_t i = 0; i < width; i++)
					row[i] -= along * base[i];
			}
		const double rest = sqrt(dot(row, row, width));
		if (!(rest > ROUNDING * before))
			continue;
		for (size_t i = 0; i < width; i++)
			to[i] = row[i] / rest;
		rank++;
	}
	RB_ASSERT(rank <= rows);
	return rows - rank;
}

enum rb_status rb_mobility_of(struct rb_mobility *mobility, const struct rb_model *model,
                              struct rb_error *err)
{
	const int joints = model->joints ? model->joints->count : 0;
	const size_t width = 6 * (size_t)model->body_count;
	const int each = model->features & RB_FEATURE_ROTATION ? 6 : 3;
	int rows = 0;

	*mobility = (struct rb_mobility){.counted = true};
	for (int i = 0; i < model->body_count; i++)
		mobility->freedoms += is_free(model, i) ? each : 0;
	for (int k = 0; k < joints; k++)
		if (!model->joints->joint[k].link.type->one_sided)
			mobility->rows += rb_linkage_row_count(&model->joints->joint[k].link);
	mobility->freedoms -= mobility->rows;
	if (mobility->rows == 0)
		return RB_OK;
	if (mobility->rows > ROWS_MAX) {
		mobility->counted = false;
		return RB_OK;
	}
	double *const matrix = rb_memory_take((size_t)mobility->rows * width, sizeof *matrix);
	if (!matrix)
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot count the freedoms of joints: out of memory");
	for (int k = 0; k < joints; k++)
		if (!model->joints->joint[k].link.type->one_sided)
			rows += fill(model, &model->joints->joint[k], matrix + (size_t)rows * width,
			             width);
	RB_ASSERT(rows == mobility->rows);
	mobility->redundant = reduce(matrix, rows, width);
	mobility->freedoms += mobility->redundant;
	rb_memory_free(matrix);
	return RB_OK;
}
