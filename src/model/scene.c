/* SPDX-License-Identifier: MIT */
/*
 * Construction of a scene: growing arrays of plain rows, texts and arrays of solids copied into
 * blocks that never move, so that rows may point to them. Defaults of every row are here and
 * nowhere else; NAN stands for "not given" where zero is a value. Nothing is checked but what would
 * make the arrays inconsistent; whether the scene is possible is for model/validate, once it is
 * complete.
 */
#include <rbsim/scene.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "math/quat.h"
#include "model/joint_type.h"
#include "model/shape.h"

/*
 * Size of a block of texts, bytes. Texts never move and are freed together; one longer than a
 * quarter of this gets a block of its own.
 */
enum { TEXT_BLOCK_SIZE = 4096 };

struct text_block {
	struct text_block *next;
	size_t size, used;
	_Alignas(max_align_t) char bytes[];
};

/* Growing arrays, as indices of their capacities. */
enum {
	ARRAY_MATERIALS,
	ARRAY_PAIRS,
	ARRAY_BODIES,
	ARRAY_SOLIDS,
	ARRAY_FORCES,
	ARRAY_FIELDS,
	ARRAY_JOINTS,
	ARRAY_GROUPS,
	ARRAY_CAMERAS,
	ARRAY_FILMS,
	ARRAY_PARAMS,
	ARRAY_EXPECTS,
	ARRAY_RESULTS,
	ARRAY_PROBES,
	ARRAY_FILES,
	ARRAY_COUNT
};

struct rb_scene_memory {
	struct text_block *texts; /* newest first */
	size_t capacity[ARRAY_COUNT];
};

enum { GROUP_MAX = 63 }; /* bits of a filter, less the one of bodies in no group */

/*
 * `size` zeroed bytes that stay where they are until the scene is released; NULL when memory is
 * out.
 */
static char *take_bytes(struct rb_scene *scene, size_t size)
{
	struct rb_scene_memory *memory = scene->memory;
	struct text_block *block = memory->texts;

	if (!block || block->size - block->used < size) {
		const size_t capacity = size > TEXT_BLOCK_SIZE / 4 ? size : TEXT_BLOCK_SIZE;

		block = rb_memory_take(1, sizeof *block + capacity);
		if (!block)
			return NULL;
		block->size = capacity;
		/*
		 * inserted behind the current block if it is full at once, so that the current
		 * one's rest is used
		 */
		if (capacity == size && memory->texts) {
			block->next = memory->texts->next;
			memory->texts->next = block;
		} else {
			block->next = memory->texts;
			memory->texts = block;
		}
	}
	RB_ASSERT(block->used <= block->size && size <= block->size - block->used);
	char *bytes = block->bytes + block->used;
	block->used += size;
	return bytes;
}

/* Aligned copy of an array; NULL and no failure where it is empty. */
static void *take_copy(struct rb_scene *scene, const void *from, size_t count, size_t size,
                       bool *failed)
{
	enum { GRAIN = _Alignof(max_align_t) };
	struct text_block *const block = scene->memory->texts;

	if (count == 0)
		return NULL;
	/* texts end at any byte */
	if (block) {
		const size_t used = (block->used + GRAIN - 1) / GRAIN * GRAIN;

		block->used = used < block->size ? used : block->size;
	}
	void *copy = count < SIZE_MAX / 2 / size
	                     ? take_bytes(scene, (count * size + GRAIN - 1) / GRAIN * GRAIN)
	                     : NULL;
	*failed = *failed || !copy;
	return copy ? memcpy(copy, from, count * size) : NULL;
}

const char *rb_scene_text(struct rb_scene *scene, const char *text)
{
	const size_t size = strlen(text) + 1;
	char *copy = take_bytes(scene, size);

	return copy ? memcpy(copy, text, size) : NULL;
}

/* Replaces `*text` by the scene's own copy; NULL stays NULL. False when memory is out. */
static bool own(struct rb_scene *scene, const char **text)
{
	if (!*text)
		return true;
	*text = rb_scene_text(scene, *text);
	return *text != NULL;
}

static enum rb_status out_of_memory(const char *what, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the scene's %s", what);
}

/* Makes room for one more element in `*array`. */
static bool reserve(struct rb_scene *scene, void *array, int which, int count, size_t size)
{
	return rb_memory_reserve(array, &scene->memory->capacity[which], (size_t)count + 1, size);
}

enum rb_status rb_scene_init(struct rb_scene *scene, struct rb_error *err)
{
	*scene = (struct rb_scene){
		.file = "",
		.world = {.title = "",
	                  .description = "",
	                  .duration_s = (double)NAN,
	                  .frame_rate = 60,
	                  .gravitation = {.constant = 6.67430e-11, .opening_angle = 0.5},
	                  .time_step_s = (double)NAN,
	                  .tolerance_m = (double)NAN,
	                  .stepped_tolerance_m = (double)NAN,
	                  .rollback = RB_ROLLBACK_SELECTIVE,
	                  .method = RB_METHOD_AUTO,
	                  .seed = 1},
		.record = {.every = 1, .fields = RB_FIELD_DEFAULT},
	};
	scene->memory = rb_memory_take(1, sizeof *scene->memory);
	if (!scene->memory)
		return out_of_memory("start", err);
	const struct rb_material_def plain = rb_material_def_default();
	const enum rb_status status = rb_scene_add_material(scene, &plain, NULL, err);
	if (status != RB_OK)
		rb_scene_release(scene);
	return status;
}

double rb_world_time_step(const struct rb_world_def *world)
{
	return isnan(world->time_step_s) ? 1 / (4 * world->frame_rate) : world->time_step_s;
}

double rb_world_duration(const struct rb_world_def *world)
{
	if (!isnan(world->duration_s) || world->steps == 0)
		return world->duration_s;
	return world->steps * rb_world_time_step(world);
}

void rb_scene_release(struct rb_scene *scene)
{
	if (scene->memory) {
		for (struct text_block *block = scene->memory->texts; block;) {
			struct text_block *next = block->next;

			rb_memory_free(block);
			block = next;
		}
	}
	rb_memory_free(scene->materials);
	rb_memory_free(scene->contact_pairs);
	rb_memory_free(scene->bodies);
	rb_memory_free(scene->solids);
	rb_memory_free(scene->forces);
	for (int k = 0; k < RB_ELEMENT_KINDS_MAX; k++)
		rb_memory_free(scene->elements[k].rows);
	rb_memory_free(scene->fields);
	rb_memory_free(scene->joints);
	rb_memory_free(scene->groups);
	rb_memory_free(scene->cameras);
	rb_memory_free(scene->films);
	rb_memory_free(scene->params);
	rb_memory_free(scene->expects);
	rb_memory_free(scene->results);
	rb_memory_free(scene->probes);
	rb_memory_free(scene->files);
	rb_memory_free(scene->memory);
	*scene = (struct rb_scene){0};
}

struct rb_body_def rb_body_def_default(void)
{
	return (struct rb_body_def){
		.call = "sphere",
		.shape = {.kind = RB_SHAPE_SPHERE, .solid = -1, .radius = (double)NAN},
		.mass = (double)NAN,
		.density = (double)NAN,
		.gravitational_mass = (double)NAN,
		.orientation = {1, 0, 0, 0},
		.motion = -1,
		.group = -1,
		.color = {(double)NAN, 0, 0},
		.visible = true,
	};
}

struct rb_material_def rb_material_def_default(void)
{
	return (struct rb_material_def){
		.density = 1000,
		.friction = 0.5,
		.restitution = 0,
		.color = {(double)NAN, 0, 0},
		.shininess = (double)NAN,
	};
}

struct rb_force_def rb_force_def_default(void)
{
	return (struct rb_force_def){
		.point = {(double)NAN, 0, 0},
		.duration_s = (double)INFINITY,
		.frame = RB_FORCE_WORLD,
	};
}

struct rb_joint_def rb_joint_def_default(void)
{
	const rb_vec3 none = {(double)NAN, 0, 0};

	return (struct rb_joint_def){
		.a = -1,
		.b = -1,
		.at = none,
		.at_a = none,
		.at_b = none,
		.axis = none,
		.axis_b = none,
		.length_m = (double)NAN,
		.limits = {(double)NAN, (double)NAN},
		.motor_speed = (double)NAN,
		.motor_function = -1,
		.visible = true,
		.radius_m = (double)NAN,
		.color = {(double)NAN, 0, 0},
	};
}

struct rb_camera_def rb_camera_def_default(void)
{
	return (struct rb_camera_def){
		.position = {.value = {6, -8, 4}, .body = -1, .function = -1},
		.look_at = {.body = -1, .function = -1},
		.up = {.value = {0, 0, 1}, .body = -1, .function = -1},
		.mount = -1,
		.fov = 0.78539816339744828, /* 45 degrees */
		.height = (double)NAN,
		.near = (double)NAN,
		.far = (double)NAN,
		.size_px = {1280, 720},
		.fps = (double)NAN,
		.speed = 1,
		.to_s = (double)INFINITY,
		.background = {(double)NAN, 0, 0},
		.light_count = -1,
		.shadows = true,
		.samples = 4,
	};
}

enum rb_status rb_scene_add_material(struct rb_scene *scene, const struct rb_material_def *def,
                                     int *index, struct rb_error *err)
{
	struct rb_material_def material = *def;

	if (!own(scene, &material.name) || !own(scene, &material.texture) ||
	    !reserve(scene, &scene->materials, ARRAY_MATERIALS, scene->material_count,
	             sizeof material))
		return out_of_memory("materials", err);
	if (index)
		*index = scene->material_count;
	scene->materials[scene->material_count++] = material;
	return RB_OK;
}

enum rb_status rb_scene_add_contact_pair(struct rb_scene *scene,
                                         const struct rb_contact_pair_def *def,
                                         struct rb_error *err)
{
	if (!reserve(scene, &scene->contact_pairs, ARRAY_PAIRS, scene->contact_pair_count,
	             sizeof *def))
		return out_of_memory("contact pairs", err);
	scene->contact_pairs[scene->contact_pair_count++] = *def;
	return RB_OK;
}

enum rb_status rb_scene_add_body(struct rb_scene *scene, const struct rb_body_def *def, int *index,
                                 struct rb_error *err)
{
	struct rb_body_def body = *def;

	/* the caller has added the solid first */
	RB_ASSERT(!rb_shape_reads(&body.shape, RB_SHAPE_READS_SOLID) ||
	          (body.shape.solid >= 0 && body.shape.solid < scene->solid_count));
	body.force_first = scene->force_count;
	body.force_count = 0;
	bool failed = false;
	body.inertia = take_copy(scene, body.inertia, body.inertia ? 1 : 0, sizeof *body.inertia,
	                         &failed);
	if (failed || !own(scene, &body.name) || !own(scene, &body.call) ||
	    !own(scene, &body.texture) ||
	    !reserve(scene, &scene->bodies, ARRAY_BODIES, scene->body_count, sizeof body))
		return out_of_memory("bodies", err);
	if (index)
		*index = scene->body_count;
	scene->bodies[scene->body_count++] = body;
	return RB_OK;
}

enum rb_status rb_scene_add_solid(struct rb_scene *scene, const struct rb_solid *def, int *solid,
                                  struct rb_error *err)
{
	struct rb_solid own_copy = *def;
	const size_t faces = (size_t)def->face_count;
	bool failed = false;

	own_copy.vertices = take_copy(scene, def->vertices, (size_t)def->vertex_count,
	                              sizeof *def->vertices, &failed);
	own_copy.loops = take_copy(scene, def->loops,
	                           faces > 0 ? (size_t)def->face_first[faces] : 0,
	                           sizeof *def->loops, &failed);
	own_copy.face_first = take_copy(scene, def->face_first, faces > 0 ? faces + 1 : 0,
	                                sizeof *def->face_first, &failed);
	own_copy.edges = take_copy(scene, def->edges, (size_t)def->edge_count, sizeof *def->edges,
	                           &failed);
	own_copy.parts = take_copy(scene, def->parts, (size_t)def->part_count, sizeof *def->parts,
	                           &failed);
	if (failed ||
	    !reserve(scene, &scene->solids, ARRAY_SOLIDS, scene->solid_count, sizeof own_copy))
		return out_of_memory("solids", err);
	*solid = scene->solid_count;
	scene->solids[scene->solid_count++] = own_copy;
	return RB_OK;
}

enum rb_status rb_scene_add_force(struct rb_scene *scene, const struct rb_force_def *def,
                                  struct rb_error *err)
{
	RB_ASSERT(scene->body_count > 0);
	if (!reserve(scene, &scene->forces, ARRAY_FORCES, scene->force_count, sizeof *def))
		return out_of_memory("forces", err);
	scene->forces[scene->force_count++] = *def;
	scene->bodies[scene->body_count - 1].force_count++;
	return RB_OK;
}

enum rb_status rb_scene_add_field(struct rb_scene *scene, const struct rb_field_def *def,
                                  struct rb_error *err)
{
	if (!reserve(scene, &scene->fields, ARRAY_FIELDS, scene->field_count, sizeof *def))
		return out_of_memory("fields", err);
	scene->fields[scene->field_count++] = *def;
	return RB_OK;
}

enum rb_status rb_scene_add_joint(struct rb_scene *scene, const struct rb_joint_def *def,
                                  int *index, struct rb_error *err)
{
	struct rb_joint_def joint = *def;

	if (!own(scene, &joint.name) ||
	    !reserve(scene, &scene->joints, ARRAY_JOINTS, scene->joint_count, sizeof joint))
		return out_of_memory("joints", err);
	if (index)
		*index = scene->joint_count;
	scene->joints[scene->joint_count++] = joint;
	return RB_OK;
}

enum rb_status rb_scene_group(struct rb_scene *scene, const char *name, int *index,
                              struct rb_error *err)
{
	for (int i = 0; i < scene->group_count; i++) {
		if (strcmp(scene->groups[i], name) == 0) {
			*index = i;
			return RB_OK;
		}
	}
	*index = -1;
	if (scene->group_count >= GROUP_MAX)
		return RB_FAIL(err, RB_ERR_SCENE,
		               "group '%s' is one too many (wanted at most %d groups)", name,
		               GROUP_MAX);
	const char *copy = rb_scene_text(scene, name);
	if (!copy || !reserve(scene, &scene->groups, ARRAY_GROUPS, scene->group_count, sizeof copy))
		return out_of_memory("groups", err);
	*index = scene->group_count;
	scene->groups[scene->group_count++] = copy;
	return RB_OK;
}

/* Labels and texts of a camera. */
static bool own_texts(struct rb_scene *scene, struct rb_camera_def *camera)
{
	bool owned = true;

	for (int i = 0; i < camera->label_count; i++)
		owned &= own(scene, &camera->labels[i].text);
	for (int i = 0; i < camera->text_count; i++)
		owned &= own(scene, &camera->texts[i].text);
	for (int i = 0; i < camera->plot_count; i++)
		owned &= own(scene, &camera->plots[i].name);
	return owned;
}

static bool own_camera(struct rb_scene *scene, struct rb_camera_def *camera)
{
	return own(scene, &camera->name) && own(scene, &camera->file) && own(scene, &camera->png) &&
	       own(scene, &camera->video) && own(scene, &camera->length_unit.name) &&
	       own(scene, &camera->time_unit.name) && own_texts(scene, camera);
}

enum rb_status rb_scene_add_film(struct rb_scene *scene, const struct rb_film_def *def,
                                 struct rb_error *err)
{
	struct rb_film_def film = *def;

	RB_ASSERT(film.cell_count > 0 && film.cell_count <= RB_FILM_CELLS_MAX);
	if (!own_camera(scene, &film.camera) ||
	    !reserve(scene, &scene->films, ARRAY_FILMS, scene->film_count, sizeof film))
		return out_of_memory("films", err);
	scene->films[scene->film_count++] = film;
	return RB_OK;
}

enum rb_status rb_scene_add_camera(struct rb_scene *scene, const struct rb_camera_def *def,
                                   struct rb_error *err)
{
	struct rb_camera_def camera = *def;

	if (!own_camera(scene, &camera) ||
	    !reserve(scene, &scene->cameras, ARRAY_CAMERAS, scene->camera_count, sizeof camera))
		return out_of_memory("cameras", err);
	scene->cameras[scene->camera_count++] = camera;
	return RB_OK;
}

enum rb_status rb_scene_add_param(struct rb_scene *scene, const struct rb_param_def *def,
                                  struct rb_error *err)
{
	struct rb_param_def param = *def;

	if (!own(scene, &param.name) || !own(scene, &param.help) ||
	    !own(scene, &param.default_text) || !own(scene, &param.value_text) ||
	    !own(scene, &param.choices) ||
	    !reserve(scene, &scene->params, ARRAY_PARAMS, scene->param_count, sizeof param))
		return out_of_memory("parameters", err);
	scene->params[scene->param_count++] = param;
	return RB_OK;
}

enum rb_status rb_scene_add_expect(struct rb_scene *scene, const struct rb_expect_def *def,
                                   struct rb_error *err)
{
	struct rb_expect_def expect = *def;

	if (!own(scene, &expect.text) ||
	    !reserve(scene, &scene->expects, ARRAY_EXPECTS, scene->expect_count, sizeof expect))
		return out_of_memory("expectations", err);
	scene->expects[scene->expect_count++] = expect;
	return RB_OK;
}

enum rb_status rb_scene_add_measure(struct rb_scene *scene, bool probe,
                                    const struct rb_measure_def *def, struct rb_error *err)
{
	struct rb_measure_def measure = *def;
	struct rb_measure_def **const list = probe ? &scene->probes : &scene->results;
	int *const count = probe ? &scene->probe_count : &scene->result_count;

	RB_ASSERT(*count < RB_MEASURES_MAX && def->name && def->units && def->description);
	if (!own(scene, &measure.name) || !own(scene, &measure.units) ||
	    !own(scene, &measure.description) ||
	    !reserve(scene, list, probe ? ARRAY_PROBES : ARRAY_RESULTS, *count, sizeof measure))
		return out_of_memory(probe ? "probes" : "results", err);
	(*list)[(*count)++] = measure;
	return RB_OK;
}

enum rb_status rb_scene_add_file(struct rb_scene *scene, const char *name, const char *text,
                                 size_t size_bytes, const char *sha256, struct rb_error *err)
{
	struct rb_source_file file = {.name = name, .size_bytes = size_bytes};
	char *copy = size_bytes < SIZE_MAX ? take_bytes(scene, size_bytes + 1) : NULL;

	if (!copy || !own(scene, &file.name) ||
	    !reserve(scene, &scene->files, ARRAY_FILES, scene->file_count, sizeof file))
		return out_of_memory("files", err);
	if (size_bytes > 0)
		memcpy(copy, text, size_bytes);
	copy[size_bytes] = '\0';
	file.text = copy;
	snprintf(file.sha256, sizeof file.sha256, "%s", sha256 ? sha256 : "");
	scene->files[scene->file_count++] = file;
	return RB_OK;
}

const char *rb_joint_kind_name(int kind)
{
	return kind >= 0 && kind < RB_JOINT_KIND_COUNT ? rb_joint_types[kind]->name : "unknown";
}

const char *rb_scene_body_label(const struct rb_scene *scene, int id, char out[64])
{
	const char *name = id >= 0 && id < scene->body_count ? scene->bodies[id].name : NULL;

	if (name)
		snprintf(out, 64, "%.63s", name);
	else
		snprintf(out, 64, "#%d", id);
	return out;
}

const char *rb_scene_body_source(const struct rb_scene *scene, int id, char out[96])
{
	RB_ASSERT(id >= 0 && id < scene->body_count);
	out[0] = '\0';
	if (scene->bodies[id].line > 0)
		rb_error_place(scene->file, scene->bodies[id].line, out, 96);
	return out;
}

rb_quat rb_plane_orientation(rb_vec3 normal, rb_vec3 axis)
{
	const rb_vec3 z = rb_vec3_unit(normal, (rb_vec3){0, 0, 1});
	rb_vec3 x = {0, 0, 0};

	if (!isnan(axis.x)) {
		const rb_vec3 along = rb_vec3_unit(axis, x);
		x = rb_vec3_add_scaled(along, -rb_vec3_dot(along, z), z);
	}
	/*
	 * less than 1e-8 of the axis is across the normal: its direction there is rounding, use the
	 * default
	 */
	if (rb_vec3_length(x) < 1e-8)
		x = rb_vec3_add_scaled((rb_vec3){1, 0, 0}, -z.x, z);
	if (rb_vec3_length(x) < 1e-8)
		x = rb_vec3_add_scaled((rb_vec3){0, 1, 0}, -z.y, z);
	x = rb_vec3_unit(x, rb_vec3_across(z));
	const rb_vec3 y = rb_vec3_cross(z, x);
	const rb_mat3 r = {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
	RB_ASSERT_COSTLY(!(fabs(rb_vec3_dot(x, z)) > 1e-12));
	return rb_quat_from_mat3(&r);
}
