/* SPDX-License-Identifier: MIT */
/*
 * Everything that is known before the first frame. Columns of structs (materials, bodies, cameras,
 * forces) are described by tables of cells, name, kind and offset, and written by one function;
 * what needs more than a copy has a function of its own. A table that is empty, or a feature that
 * the scene lacks, leaves no dataset.
 */
#include "sink/h5about.h"

#include "base/error.h"
#include "base/hash.h"
#include "base/memory.h"
#include "model/element.h"
#include "model/joints.h"
#include "sink/h5solids.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A column made from one member of an array of structs. */
enum cell_kind { CELL_NUMBER, CELL_INT, CELL_BOOL, CELL_TEXT };
struct cell {
	const char *name;
	enum cell_kind kind;
	int width; /* numbers in one cell; 1: a plain column */
	size_t offset;
	const char *units;
};

static const struct cell material_cells[] = {
	{"name", CELL_TEXT, 1, offsetof(struct rb_material_def, name), NULL},
	{"density", CELL_NUMBER, 1, offsetof(struct rb_material_def, density), "kg/m^3"},
	{"friction", CELL_NUMBER, 1, offsetof(struct rb_material_def, friction), NULL},
	{"restitution", CELL_NUMBER, 1, offsetof(struct rb_material_def, restitution), NULL},
	{"color", CELL_NUMBER, 3, offsetof(struct rb_material_def, color), NULL},
	{"texture", CELL_TEXT, 1, offsetof(struct rb_material_def, texture), NULL},
	{"shininess", CELL_NUMBER, 1, offsetof(struct rb_material_def, shininess), NULL},
};

/* By id: all bodies of the scene. */
static const struct cell body_cells[] = {
	{"kind", CELL_INT, 1, offsetof(struct rb_body_def, shape.kind), NULL},
	{"radius", CELL_NUMBER, 1, offsetof(struct rb_body_def, shape.radius), "m"},
	{"size", CELL_NUMBER, 3, offsetof(struct rb_body_def, shape.size), "m"},
	{"material", CELL_INT, 1, offsetof(struct rb_body_def, material), NULL},
	{"static", CELL_BOOL, 1, offsetof(struct rb_body_def, is_static), NULL},
	{"color", CELL_NUMBER, 3, offsetof(struct rb_body_def, color), NULL},
	{"texture", CELL_TEXT, 1, offsetof(struct rb_body_def, texture), NULL},
	{"visible", CELL_BOOL, 1, offsetof(struct rb_body_def, visible), NULL},
};

#define CAMERA(member) offsetof(struct rb_camera_def, member)
static const struct cell camera_cells[] = {
	{"name", CELL_TEXT, 1, CAMERA(name), NULL},
	{"position_source", CELL_INT, 1, CAMERA(position.source), NULL},
	{"position", CELL_NUMBER, 3, CAMERA(position.value), "m"},
	{"position_body", CELL_INT, 1, CAMERA(position.body), NULL},
	{"look_at_source", CELL_INT, 1, CAMERA(look_at.source), NULL},
	{"look_at", CELL_NUMBER, 3, CAMERA(look_at.value), "m"},
	{"look_at_body", CELL_INT, 1, CAMERA(look_at.body), NULL},
	{"up_source", CELL_INT, 1, CAMERA(up.source), NULL},
	{"up", CELL_NUMBER, 3, CAMERA(up.value), NULL},
	{"up_body", CELL_INT, 1, CAMERA(up.body), NULL},
	{"mount", CELL_INT, 1, CAMERA(mount), NULL},
	{"offset", CELL_NUMBER, 3, CAMERA(offset), "m"},
	{"level", CELL_BOOL, 1, CAMERA(level), NULL},
	{"fov", CELL_NUMBER, 1, CAMERA(fov), "rad"},
	{"orthographic", CELL_BOOL, 1, CAMERA(orthographic), NULL},
	{"height", CELL_NUMBER, 1, CAMERA(height), "m"},
	{"has_frustum", CELL_BOOL, 1, CAMERA(has_frustum), NULL},
	{"frustum", CELL_NUMBER, 6, CAMERA(frustum), "m"},
	{"near", CELL_NUMBER, 1, CAMERA(near), "m"},
	{"far", CELL_NUMBER, 1, CAMERA(far), "m"},
	{"size", CELL_INT, 2, CAMERA(size_px), NULL},
	{"fps", CELL_NUMBER, 1, CAMERA(fps), "1/s"},
	{"speed", CELL_NUMBER, 1, CAMERA(speed), NULL},
	{"from", CELL_NUMBER, 1, CAMERA(from_s), "s"},
	{"to", CELL_NUMBER, 1, CAMERA(to_s), "s"},
	{"background", CELL_NUMBER, 3, CAMERA(background), NULL},
	{"light_count", CELL_INT, 1, CAMERA(light_count), NULL},
	{"shadows", CELL_BOOL, 1, CAMERA(shadows), NULL},
	{"samples", CELL_INT, 1, CAMERA(samples), NULL},
	{"overlay", CELL_INT, 1, CAMERA(overlay), NULL},
	{"vectors", CELL_INT, 1, CAMERA(vectors), NULL},
	{"length_unit", CELL_TEXT, 1, CAMERA(length_unit.name), NULL},
	{"length_unit_size", CELL_NUMBER, 1, CAMERA(length_unit.size), "m"},
	{"time_unit", CELL_TEXT, 1, CAMERA(time_unit.name), NULL},
	{"time_unit_size", CELL_NUMBER, 1, CAMERA(time_unit.size), "s"},
	{"trail_count", CELL_INT, 1, CAMERA(trail_count), NULL},
	{"trails", CELL_INT, RB_CAMERA_TRAILS_MAX, CAMERA(trails), NULL},
	{"wireframe", CELL_BOOL, 1, CAMERA(wireframe), NULL},
	{"png", CELL_TEXT, 1, CAMERA(png), NULL},
	{"video", CELL_TEXT, 1, CAMERA(video), NULL},
};

_Static_assert(sizeof(enum rb_shape_kind) == 4 && sizeof(enum rb_camera_source) == 4 &&
                       sizeof(int) == 4,
               "enums and ints are recorded as 32-bit integers");

static const struct cell force_cells[] = {
	{"vector", CELL_NUMBER, 3, offsetof(struct rb_force_def, vector), "N"},
	{"torque", CELL_NUMBER, 3, offsetof(struct rb_force_def, torque), "N m"},
	{"point", CELL_NUMBER, 3, offsetof(struct rb_force_def, point), "m"},
	{"start", CELL_NUMBER, 1, offsetof(struct rb_force_def, start_s), "s"},
	{"duration", CELL_NUMBER, 1, offsetof(struct rb_force_def, duration_s), "s"},
	{"frame", CELL_INT, 1, offsetof(struct rb_force_def, frame), NULL},
};

#define JOINT(member) offsetof(struct rb_joint_def, member)
static const struct cell joint_cells[] = {
	{"name", CELL_TEXT, 1, JOINT(name), NULL},
	{"kind", CELL_INT, 1, JOINT(kind), NULL},
	{"a", CELL_INT, 1, JOINT(a), NULL},
	{"b", CELL_INT, 1, JOINT(b), NULL},
	{"axis", CELL_NUMBER, 3, JOINT(axis), NULL},
	{"axis_b", CELL_NUMBER, 3, JOINT(axis_b), NULL},
	{"limits", CELL_NUMBER, 2, JOINT(limits), "rad, m"},
	{"restitution", CELL_NUMBER, 1, JOINT(restitution), NULL},
	{"friction", CELL_NUMBER, 1, JOINT(friction), "N m, N"},
	{"motor_speed", CELL_NUMBER, 1, JOINT(motor_speed), "rad/s, m/s"},
	{"motor_max", CELL_NUMBER, 1, JOINT(motor_max), "N m, N"},
	{"stiffness", CELL_NUMBER, 1, JOINT(stiffness), "N m/rad, N/m"},
	{"damping", CELL_NUMBER, 1, JOINT(damping), "N m s/rad, N s/m"},
	{"rest", CELL_NUMBER, 1, JOINT(rest), "rad, m"},
	{"collides", CELL_BOOL, 1, JOINT(collides), NULL},
};

struct rows {
	const char *group; /* path */
	const void *first;
	size_t count, stride;
};

/* Records a failure, unless one stands already. */
static void no_memory(struct rb_h5 *h5, const char *path)
{
	if (!h5->status)
		h5->status = RB_FAIL(&h5->error, RB_ERR_MEMORY, "cannot record '%s': out of memory",
		                     path);
}

/* Writes one column of an array of structs. */
static void put_cells(struct rb_h5 *h5, const struct rows *rows, const struct cell *cell)
{
	static const size_t size_of[] = {sizeof(double), sizeof(int), sizeof(bool), sizeof(char *)};
	static const enum rb_h5_kind kind_of[] = {RB_H5_F64, RB_H5_I32, RB_H5_I8, RB_H5_I8};
	const size_t bytes = size_of[cell->kind] * (size_t)cell->width;
	char path[160];

	RB_ASSERT(cell->width > 0);
	snprintf(path, sizeof path, "%s/%s", rows->group, cell->name);
	unsigned char *column = rb_memory_take(rows->count, bytes);
	if (!column) {
		no_memory(h5, path);
		return;
	}
	for (size_t i = 0; i < rows->count; i++)
		memcpy(column + i * bytes,
		       (const unsigned char *)rows->first + i * rows->stride + cell->offset, bytes);
	if (cell->kind == CELL_TEXT)
		rb_h5_texts(h5, path, (const char *const *)(void *)column, rows->count);
	else
		rb_h5_put(
			h5, path, kind_of[cell->kind],
			(rb_h5_shape){cell->width > 1 ? 2 : 1, {rows->count, (hsize_t)cell->width}},
			column);
	rb_h5_units(h5, path, cell->units);
	rb_memory_free(column);
}

/* Writes a group with all columns of an array; an empty array leaves an empty group. */
static void put_table(struct rb_h5 *h5, const struct rows *rows, const struct cell *cells,
                      size_t cell_count)
{
	rb_h5_group(h5, rows->group);
	for (size_t i = 0; i < cell_count && rows->count > 0; i++)
		put_cells(h5, rows, &cells[i]);
}

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* What H5MD 1.1 asks for at the root. */
static void put_h5md(struct rb_h5 *h5, const struct rb_run_info *info)
{
	rb_h5_group(h5, "/h5md");
	rb_h5_attribute(h5, "/h5md", "version", RB_H5_I32, 2, (const int[]){1, 1});
	rb_h5_group(h5, "/h5md/author");
	rb_h5_attribute_text(h5, "/h5md/author", "name", info->author);
	rb_h5_group(h5, "/h5md/creator");
	rb_h5_attribute_text(h5, "/h5md/creator", "name", "rbsim");
	rb_h5_attribute_text(h5, "/h5md/creator", "version", info->version);
	rb_h5_group(h5, "/h5md/modules");
	rb_h5_group(h5, "/h5md/modules/units");
	rb_h5_attribute(h5, "/h5md/modules/units", "version", RB_H5_I32, 2, (const int[]){1, 0});
	rb_h5_attribute_text(h5, "/h5md/modules/units", "system", "SI");
}

/*
 * The simulation box of H5MD, which we have not: no dimension is periodic. H5MD wants one text for
 * each axis.
 */
static void put_box(struct rb_h5 *h5)
{
	static const char none[3][4] = {
		{'n', 'o', 'n', 'e'}, {'n', 'o', 'n', 'e'}, {'n', 'o', 'n', 'e'}};

	rb_h5_group(h5, "/particles/bodies");
	rb_h5_group(h5, "/particles/bodies/box");
	rb_h5_attribute(h5, "/particles/bodies/box", "dimension", RB_H5_I32, 0, &(int){3});
	if (h5->status)
		return;
	const hid_t box = H5Gopen2(h5->file, "/particles/bodies/box", H5P_DEFAULT);
	const hid_t type = H5Tcopy(H5T_C_S1);
	H5Tset_size(type, sizeof none[0]);
	H5Tset_strpad(type, H5T_STR_NULLPAD);
	const hid_t space = H5Screate_simple(1, (const hsize_t[]){3}, NULL);
	const hid_t boundary = H5Acreate2(box, "boundary", type, space, H5P_DEFAULT, H5P_DEFAULT);
	if (boundary < 0 || H5Awrite(boundary, type, none) < 0)
		rb_h5_fail(h5, "describe", "/particles/bodies/box");
	rb_h5_done(boundary);
	rb_h5_done(space);
	rb_h5_done(type);
	rb_h5_done(box);
}

/* Writes id and species (material) of the indices [first, first + count). */
static void put_who(struct rb_h5 *h5, const struct rb_model *model, const char *group, int first,
                    int count)
{
	char path[80];
	int *species = rb_memory_take((size_t)count, sizeof *species);

	RB_ASSERT(first >= 0 && count >= 0);
	if (!species) {
		no_memory(h5, group);
		return;
	}
	for (int i = 0; i < count; i++)
		species[i] = model->material[first + i];
	const rb_h5_shape shape = {1, {(hsize_t)count}};
	snprintf(path, sizeof path, "%s/id", group);
	rb_h5_put(h5, path, RB_H5_I32, shape, model->id_of + first);
	snprintf(path, sizeof path, "%s/species", group);
	rb_h5_put(h5, path, RB_H5_I32, shape, species);
	rb_memory_free(species);
}

static void put_inertia(struct rb_h5 *h5, const struct rb_model *model)
{
	const hsize_t count = (hsize_t)model->body_count;
	rb_mat3 *const inertia = rb_memory_take(count, sizeof *inertia);

	for (int i = 0; inertia && i < model->body_count; i++)
		inertia[i] = *rb_model_inertia(model, i);
	if (!inertia)
		no_memory(h5, "/particles/bodies/inertia");
	rb_h5_put(h5, "/particles/bodies/inertia", RB_H5_F64, (rb_h5_shape){3, {count, 3, 3}},
	          inertia);
	rb_h5_units(h5, "/particles/bodies/inertia", "kg m^2");
	rb_memory_free(inertia);
}

/* Writes what moving bodies keep over the run. */
static void put_bodies(struct rb_h5 *h5, const struct rb_model *model)
{
	const hsize_t count = (hsize_t)model->body_count;

	put_box(h5);
	put_who(h5, model, "/particles/bodies", 0, model->body_count);
	rb_h5_put(h5, "/particles/bodies/mass", RB_H5_F64, (rb_h5_shape){1, {count}}, model->mass);
	rb_h5_units(h5, "/particles/bodies/mass", "kg");
	if (model->inertia)
		put_inertia(h5, model);
	rb_vec3 *none = model->center_of_mass ? NULL : rb_memory_take(count, sizeof *none);
	if (!model->center_of_mass && !none)
		no_memory(h5, "/particles/bodies/center_of_mass");
	rb_h5_put(h5, "/particles/bodies/center_of_mass", RB_H5_F64, (rb_h5_shape){2, {count, 3}},
	          none ? none : model->center_of_mass);
	rb_h5_units(h5, "/particles/bodies/center_of_mass", "m");
	rb_memory_free(none);
	if (!(model->features & RB_FEATURE_ROTATION))
		rb_h5_put(h5, "/particles/bodies/orientation", RB_H5_F64,
		          (rb_h5_shape){2, {count, 4}}, model->orientation);
}

/* Writes the bodies that never move. */
static void put_statics(struct rb_h5 *h5, const struct rb_model *model)
{
	const hsize_t count = (hsize_t)model->static_count;

	rb_h5_group(h5, "/particles/statics");
	put_who(h5, model, "/particles/statics", model->body_count, model->static_count);
	rb_h5_put(h5, "/particles/statics/position", RB_H5_F64, (rb_h5_shape){2, {count, 3}},
	          model->position + model->body_count);
	rb_h5_units(h5, "/particles/statics/position", "m");
	rb_h5_put(h5, "/particles/statics/orientation", RB_H5_F64, (rb_h5_shape){2, {count, 4}},
	          model->orientation + model->body_count);
}

/*
 * Writes a parameter as a value of its type, with its text and all that the scene says of it as
 * attributes.
 */
static void put_param(struct rb_h5 *h5, const struct rb_param_def *param)
{
	char name[256], path[300];

	snprintf(path, sizeof path, "/rbsim/parameters/%s",
	         rb_h5_escape(param->name, name, sizeof name));
	switch (param->type) {
	case RB_PARAM_NUMBER:
		rb_h5_put_f64(h5, path, param->value);
		break;
	case RB_PARAM_INTEGER:
		rb_h5_put_i64(h5, path, (int64_t)param->value);
		break;
	case RB_PARAM_BOOLEAN:
		rb_h5_put(h5, path, RB_H5_I8, (rb_h5_shape){0}, &(int8_t){param->value != 0});
		break;
	case RB_PARAM_TEXT:
		rb_h5_text(h5, path, param->value_text, 0);
		break;
	}
	if (param->type != RB_PARAM_TEXT)
		rb_h5_attribute_text(h5, path, "text", param->value_text);
	rb_h5_attribute_text(h5, path, "default", param->default_text);
	rb_h5_attribute_text(h5, path, "help", param->help);
	if (!isnan(param->min))
		rb_h5_attribute(h5, path, "min", RB_H5_F64, 0, &param->min);
	if (!isnan(param->max))
		rb_h5_attribute(h5, path, "max", RB_H5_F64, 0, &param->max);
	if (param->choices)
		rb_h5_attribute_text(h5, path, "choices", param->choices);
}

/*
 * Writes a file of the scene. Texts end at their first zero byte for many readers: what has one is
 * kept as numbers.
 */
static void put_source(struct rb_h5 *h5, const char *path, const struct rb_source_file *file)
{
	const size_t size = file->size_bytes;
	char sha256[65];

	rb_hash_sha256(file->text, size, sha256);
	if (size > 0 && memchr(file->text, '\0', size))
		rb_h5_put(h5, path, RB_H5_U8, (rb_h5_shape){1, {size}}, file->text);
	else
		rb_h5_text_sized(h5, path, file->text, size);
	rb_h5_attribute_text(h5, path, "name", file->name);
	rb_h5_attribute_text(h5, path, "sha256", sha256);
}

/* Writes parameters and files, in the order of the scene. */
static void put_scene(struct rb_h5 *h5, const struct rb_scene *scene)
{
	char name[400], path[440];

	rb_h5_group_ordered(h5, "/rbsim/parameters");
	for (int i = 0; i < scene->param_count; i++)
		put_param(h5, &scene->params[i]);
	if (scene->file_count > 0)
		put_source(h5, "/rbsim/scene", &scene->files[0]);
	else
		rb_h5_text(h5, "/rbsim/scene", "", 0);
	rb_h5_group_ordered(h5, "/rbsim/files");
	for (int i = 1; i < scene->file_count; i++) {
		snprintf(path, sizeof path, "/rbsim/files/%s",
		         rb_h5_escape(scene->files[i].name, name, sizeof name));
		put_source(h5, path, &scene->files[i]);
	}
}

/* Writes which bodies a function of time moves, by id; absent where there is none. */
static void put_driven(struct rb_h5 *h5, const struct rb_model *model)
{
	const size_t count = (size_t)model->scene->body_count;

	if (!model->driven)
		return;
	unsigned char *driven = rb_memory_take(count, 1);
	if (!driven) {
		no_memory(h5, "/rbsim/shapes/driven");
		return;
	}
	for (int i = 0; i < model->body_count; i++)
		driven[model->id_of[i]] = model->driven[i];
	rb_h5_put(h5, "/rbsim/shapes/driven", RB_H5_I8, (rb_h5_shape){1, {count}}, driven);
	rb_memory_free(driven);
}

/*
 * Writes who meets whom, by id: those that have each other's bit of `group` in `collides_with`.
 * Absent without such filters.
 */
static void put_filters(struct rb_h5 *h5, const struct rb_model *model)
{
	const size_t count = (size_t)model->scene->body_count;

	if (!model->collides)
		return;
	uint64_t *const column = rb_memory_take(2 * count, sizeof *column);
	if (!column) {
		no_memory(h5, "/rbsim/shapes/group");
		return;
	}
	for (size_t i = 0; i < count; i++) {
		column[model->id_of[i]] = model->group_bit[i];
		column[count + (size_t)model->id_of[i]] = model->collides[i];
	}
	rb_h5_put(h5, "/rbsim/shapes/group", RB_H5_U64, (rb_h5_shape){1, {count}}, column);
	rb_h5_put(h5, "/rbsim/shapes/collides_with", RB_H5_U64, (rb_h5_shape){1, {count}},
	          column + count);
	rb_memory_free(column);
}

/* Writes the forces that bodies have of their own; `body` is an id. */
static void put_own_forces(struct rb_h5 *h5, const struct rb_scene *scene)
{
	const size_t count = (size_t)scene->force_count;

	if (count == 0)
		return;
	put_table(h5, &(struct rows){"/rbsim/forces", scene->forces, count, sizeof *scene->forces},
	          force_cells, COUNT(force_cells));
	rb_h5_attribute_text(h5, "/rbsim/forces/frame", "frames", "0 world, 1 body");
	int *const body = rb_memory_take(count, sizeof *body);
	if (!body) {
		no_memory(h5, "/rbsim/forces/body");
		return;
	}
	for (int id = 0; id < scene->body_count; id++)
		for (int k = 0; k < scene->bodies[id].force_count; k++)
			body[scene->bodies[id].force_first + k] = id;
	rb_h5_put(h5, "/rbsim/forces/body", RB_H5_I32, (rb_h5_shape){1, {count}}, body);
	rb_memory_free(body);
}

/* Writes a group for a kind of force element, with a dataset for each of its keys. */
static void put_elements(struct rb_h5 *h5, const struct rb_elements *elements)
{
	static const struct {
		enum cell_kind kind;
		int width;
	} of[RB_ROW_TYPE_COUNT] = {
		[RB_ROW_NUMBER] = {CELL_NUMBER, 1}, [RB_ROW_INTEGER] = {CELL_INT, 1},
		[RB_ROW_BODY] = {CELL_INT, 1},      [RB_ROW_BOOLEAN] = {CELL_BOOL, 1},
		[RB_ROW_COLOR] = {CELL_NUMBER, 3},  [RB_ROW_VECTOR] = {CELL_NUMBER, 3}};
	const struct rb_element_kind *kind = elements->kind;
	char group[80];

	snprintf(group, sizeof group, "/rbsim/%ss", kind->name);
	rb_h5_group(h5, group);
	for (int k = 0; k < kind->keys.count; k++) {
		const struct rb_row *key = &kind->keys.rows[k];
		const struct cell cell = {key->key, of[key->type].kind, of[key->type].width,
		                          key->at, *key->unit ? key->unit : NULL};

		RB_ASSERT(cell.width > 0);
		put_cells(h5,
		          &(struct rows){group, elements->rows, (size_t)elements->count,
		                         kind->row_size},
		          &cell);
	}
}

/* Where a joint is at the start, as sealed. */
struct joint_start {
	double point_a[3], point_b[3]; /* m, world coordinates */
	double length;                 /* m, of rods and ropes; 0: the kind has none */
};
static const struct cell start_cells[] = {
	{"point_a", CELL_NUMBER, 3, offsetof(struct joint_start, point_a), "m"},
	{"point_b", CELL_NUMBER, 3, offsetof(struct joint_start, point_b), "m"},
	{"length", CELL_NUMBER, 1, offsetof(struct joint_start, length), "m"},
};

/* Writes what does not change of joints; a scene without them has no such group. */
static void put_joints(struct rb_h5 *h5, const struct rb_model *model)
{
	const struct rb_scene *scene = model->scene;
	const size_t count = (size_t)scene->joint_count;
	char kinds[24 * RB_JOINT_KIND_COUNT];
	size_t used = 0;

	if (count == 0)
		return;
	put_table(h5, &(struct rows){"/joints", scene->joints, count, sizeof *scene->joints},
	          joint_cells, COUNT(joint_cells));
	for (int kind = 0; kind < RB_JOINT_KIND_COUNT; kind++)
		used += (size_t)snprintf(kinds + used, sizeof kinds - used, "%s%d %s",
		                         kind == 0 ? "" : ", ", kind, rb_joint_kind_name(kind));
	rb_h5_attribute_text(h5, "/joints/kind", "kinds", kinds);
	struct joint_start *const start = rb_memory_take(count, sizeof *start);
	if (!start) {
		no_memory(h5, "/joints/point_a");
		return;
	}
	for (size_t k = 0; k < count; k++) {
		rb_vec3 a, b;

		rb_joint_points(scene, &scene->joints[k], &a, &b);
		rb_vec3_to(start[k].point_a, a);
		rb_vec3_to(start[k].point_b, b);
		start[k].length = model->joints->joint[k].link.length;
	}
	for (size_t i = 0; i < COUNT(start_cells); i++)
		put_cells(h5, &(struct rows){"/joints", start, count, sizeof *start},
		          &start_cells[i]);
	rb_memory_free(start);
}

/* Writes forces between and on bodies; a scene without them has none of these groups. */
static void put_forces(struct rb_h5 *h5, const struct rb_model *model)
{
	const struct rb_scene *scene = model->scene;

	for (int k = 0; k < model->element_list_count; k++)
		put_elements(h5, &model->elements[k]);
	put_own_forces(h5, scene);
	put_joints(h5, model);
	if (scene->field_count > 0)
		rb_h5_put_i64(h5, "/rbsim/fields", scene->field_count);
}

/* Writes the tables of materials, bodies, forces and cameras. */
static void put_tables(struct rb_h5 *h5, const struct rb_model *model, const struct rb_scene *scene)
{
	static const struct cell name = {"names", CELL_TEXT, 1, offsetof(struct rb_body_def, name),
	                                 NULL};
	const size_t bodies = (size_t)scene->body_count;
	const hsize_t count = (hsize_t)model->material_count;

	put_cells(h5, &(struct rows){"/rbsim", scene->bodies, bodies, sizeof *scene->bodies},
	          &name);
	put_table(h5,
	          &(struct rows){"/rbsim/materials", scene->materials,
	                         (size_t)scene->material_count, sizeof *scene->materials},
	          material_cells, COUNT(material_cells));
	/* the dense table: what two of them do together */
	double *pair = rb_memory_take(count * count, sizeof *pair);
	if (!pair) {
		no_memory(h5, "/rbsim/materials/pair_friction");
		return;
	}
	for (hsize_t i = 0; i < count * count; i++)
		pair[i] = model->pair_materials[i].friction;
	rb_h5_put(h5, "/rbsim/materials/pair_friction", RB_H5_F64, (rb_h5_shape){2, {count, count}},
	          pair);
	for (hsize_t i = 0; i < count * count; i++)
		pair[i] = model->pair_materials[i].restitution;
	rb_h5_put(h5, "/rbsim/materials/pair_restitution", RB_H5_F64,
	          (rb_h5_shape){2, {count, count}}, pair);
	rb_memory_free(pair);

	put_table(h5, &(struct rows){"/rbsim/shapes", scene->bodies, bodies, sizeof *scene->bodies},
	          body_cells, COUNT(body_cells));
	char kinds[160];
	rb_solids_kinds(kinds);
	rb_h5_attribute_text(h5, "/rbsim/shapes", "kinds", kinds);
	rb_solids_write(h5, scene);
	put_driven(h5, model);
	put_filters(h5, model);
	put_forces(h5, model);
	put_table(h5,
	          &(struct rows){"/rbsim/cameras", scene->cameras, (size_t)scene->camera_count,
	                         sizeof *scene->cameras},
	          camera_cells, COUNT(camera_cells));
	rb_h5_attribute_text(h5, "/rbsim/cameras", "sources", "0 fixed, 1 body, 2 function");
}

/* Position (of a sun, direction), kind, colour, intensity, look_at, angle, softness. */
enum { LIGHT_CELLS = 13 };

/* Writes the lights of all cameras as one table of numbers. */
static void put_lights(struct rb_h5 *h5, const struct rb_scene *scene)
{
	const size_t count = (size_t)scene->camera_count;
	double(*lights)[RB_CAMERA_LIGHTS_MAX][LIGHT_CELLS];

	if (count == 0)
		return;
	lights = rb_memory_take(count, sizeof *lights);
	if (!lights) {
		no_memory(h5, "/rbsim/cameras/lights");
		return;
	}
	for (size_t i = 0; i < count; i++)
		for (int k = 0; k < scene->cameras[i].light_count; k++) {
			const struct rb_light_def *light = &scene->cameras[i].lights[k];
			const double cells[LIGHT_CELLS] = {
				light->position.x, light->position.y, light->position.z,
				light->kind,       light->color[0],   light->color[1],
				light->color[2],   light->intensity,  light->look_at.x,
				light->look_at.y,  light->look_at.z,  light->angle,
				light->softness};
			memcpy(lights[i][k], cells, sizeof cells);
		}
	rb_h5_put(h5, "/rbsim/cameras/lights", RB_H5_F64,
	          (rb_h5_shape){3, {count, RB_CAMERA_LIGHTS_MAX, LIGHT_CELLS}}, lights);
	rb_memory_free(lights);
}

/* Writes what identifies the run. */
static void put_run(struct rb_h5 *h5, const struct rb_run_info *info)
{
	const struct rb_model *const model = info->model;
	const struct rb_world_def *const world = &info->scene->world;
	const struct {
		const char *path, *text;
	} texts[] = {
		{"/rbsim/version", info->version},          {"/rbsim/build", info->build},
		{"/rbsim/command", info->command},          {"/rbsim/host", info->host},
		{"/rbsim/started", info->started},          {"/rbsim/method", info->method},
		{"/rbsim/rollback", info->rollback},        {"/rbsim/title", world->title},
		{"/rbsim/description", world->description},
	};
	const struct {
		const char *path;
		double value;
		const char *units;
	} numbers[] = {
		{"/rbsim/time_step", model->time_step_s, "s"},
		{"/rbsim/tolerance", model->tolerance_m, "m"},
		{"/rbsim/stepped_tolerance", model->stepped_tolerance_m, "m"},
		{"/rbsim/frame_rate", model->frame_rate, "1/s"},
		{"/rbsim/duration", model->duration_s, "s"},
	};

	rb_h5_group(h5, "/rbsim");
	for (size_t i = 0; i < COUNT(texts); i++)
		rb_h5_text(h5, texts[i].path, texts[i].text, 0);
	for (size_t i = 0; i < COUNT(numbers); i++) {
		rb_h5_put_f64(h5, numbers[i].path, numbers[i].value);
		rb_h5_units(h5, numbers[i].path, numbers[i].units);
	}
	rb_h5_put(h5, "/rbsim/seed", RB_H5_U64, (rb_h5_shape){0}, &world->seed);
	rb_h5_put_i64(h5, "/rbsim/threads", info->threads);
	rb_h5_put(h5, "/rbsim/gravity", RB_H5_F64, (rb_h5_shape){1, {3}}, &world->gravity);
	rb_h5_units(h5, "/rbsim/gravity", "m/s^2");
	rb_h5_put(h5, "/rbsim/gravity_force", RB_H5_F64, (rb_h5_shape){1, {3}},
	          &world->gravity_force);
	rb_h5_units(h5, "/rbsim/gravity_force", "N");
}

void rb_about_write(struct rb_h5 *h5, const struct rb_run_info *info)
{
	RB_ASSERT(info->model && info->scene);
	put_h5md(h5, info);
	put_bodies(h5, info->model);
	put_statics(h5, info->model);
	rb_h5_group(h5, "/observables");
	put_run(h5, info);
	put_tables(h5, info->model, info->scene);
	put_lights(h5, info->scene);
	put_scene(h5, info->scene);
}

const char *rb_about_result_path(const char *name, char out[RB_ABOUT_PATH_SIZE])
{
	static const char folder[] = "/results/";

	memcpy(out, folder, sizeof folder);
	rb_h5_escape(name, out + sizeof folder - 1, RB_ABOUT_PATH_SIZE - sizeof folder);
	return out;
}

/* Makes the datasets of the scene's results. */
static void put_results(struct rb_h5 *h5, const struct rb_scene *scene)
{
	char path[RB_ABOUT_PATH_SIZE];

	if (scene->result_count > 0)
		rb_h5_group_ordered(h5, "/results");
	for (int i = 0; i < scene->result_count; i++) {
		rb_about_result_path(scene->results[i].name, path);
		rb_h5_put_f64(h5, path, (double)NAN);
		rb_h5_units(h5, path, scene->results[i].units);
		rb_h5_attribute_text(h5, path, "description", scene->results[i].description);
	}
}

void rb_about_rewrite_results(struct rb_h5 *h5, const struct rb_scene *scene, const double *results)
{
	char path[RB_ABOUT_PATH_SIZE];

	for (int i = 0; i < scene->result_count; i++)
		rb_h5_rewrite_f64(h5, rb_about_result_path(scene->results[i].name, path),
		                  results[i]);
}

void rb_about_write_changing(struct rb_h5 *h5, const struct rb_scene *scene)
{
	rb_h5_text(h5, "/rbsim/status", "running", RB_ABOUT_STATUS_ROOM);
	rb_h5_text(h5, "/rbsim/reason", "", RB_ABOUT_REASON_ROOM);
	rb_h5_text(h5, "/rbsim/state_hash", "", RB_ABOUT_HASH_ROOM);
	rb_h5_text(h5, "/rbsim/ended", "", RB_ABOUT_ENDED_ROOM);
	put_results(h5, scene);
}
