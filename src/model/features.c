/* SPDX-License-Identifier: MIT */
/*
 * A feature is present only if it can change a result: gravity of a scene in which nothing moves is
 * not, nor friction between materials that never touch. Stages, columns and checks of the rest do
 * not exist in the run, so no loop tests a flag for each body. Pairs of bodies are judged by
 * classes (material, mobility, filters), of which even large scenes have few.
 */
#include "model/features.h"

#include <math.h>

#include "base/error.h"
#include "geom/mass.h"
#include "model/element.h"
#include "model/joints.h"
#include "model/validate.h"

/* Class of bodies with the same answer to who can touch whom, and with what material. */
struct kind {
	const struct rb_body_def *body;
	bool several;
};

/* With more classes the answer is yes without looking: that costs columns, never correctness. */
enum { KINDS_MAX = 256 };

/* True if the scene has a callback that may apply forces or impulses. */
static bool callbacks(const struct rb_feature_facts *facts)
{
	return (facts->scene->hooks &
	        (RB_HOOK_STEP | RB_HOOK_COLLISION | RB_HOOK_FRAME | RB_HOOK_TRANSITION)) != 0;
}

static bool has_gravity(const struct rb_feature_facts *facts)
{
	return facts->moves && rb_vec3_max_abs(facts->scene->world.gravity) > 0;
}

static bool has_gravity_force(const struct rb_feature_facts *facts)
{
	return facts->moves && rb_vec3_max_abs(facts->scene->world.gravity_force) > 0;
}

static bool has_forces(const struct rb_feature_facts *facts)
{
	return facts->moves && facts->forces;
}

static bool has_pushes(const struct rb_feature_facts *facts)
{
	return facts->moves && callbacks(facts);
}

/* Contact forces turn a body by friction, or when they pass beside its centre of mass. */
static bool has_rotation(const struct rb_feature_facts *facts)
{
	return facts->driven_turns ||
	       (facts->moves &&
	        (facts->spins || facts->friction || facts->torque || facts->joints_turn ||
	         callbacks(facts) || ((facts->off_center || facts->angular) && facts->can_touch)));
}

static bool has_gyroscopic(const struct rb_feature_facts *facts)
{
	return facts->unequal && has_rotation(facts);
}

static bool has_off_center(const struct rb_feature_facts *facts)
{
	return facts->off_center;
}

static bool has_contact(const struct rb_feature_facts *facts)
{
	return facts->can_touch;
}

static bool has_friction(const struct rb_feature_facts *facts)
{
	return facts->friction;
}

static bool has_restitution(const struct rb_feature_facts *facts)
{
	return facts->restitution;
}

static bool has_filters(const struct rb_feature_facts *facts)
{
	return facts->filters;
}

static bool has_hook_step(const struct rb_feature_facts *facts)
{
	return (facts->scene->hooks & RB_HOOK_STEP) != 0;
}

static bool has_hook_collision(const struct rb_feature_facts *facts)
{
	return (facts->scene->hooks & RB_HOOK_COLLISION) != 0;
}

static bool has_hook_transition(const struct rb_feature_facts *facts)
{
	return (facts->scene->hooks & RB_HOOK_TRANSITION) != 0;
}

static bool has_events(const struct rb_feature_facts *facts)
{
	return (facts->scene->record.fields & RB_FIELD_EVENTS) != 0 || has_hook_collision(facts) ||
	       has_hook_transition(facts);
}

/* True if an element of a kind with that feature bit does anything. */
static bool has_elements(const struct rb_feature_facts *facts, rb_features bit)
{
	for (int place = 0; place < rb_element_kind_count; place++) {
		const struct rb_element_kind *kind = rb_element_kinds[place];

		for (int k = 0; kind->feature == bit && k < facts->scene->elements[place].count;
		     k++)
			if (!kind->matters ||
			    kind->matters(rb_scene_element(facts->scene, kind, k)))
				return facts->moves;
	}
	return false;
}

static bool has_springs(const struct rb_feature_facts *facts)
{
	return has_elements(facts, RB_FEATURE_SPRINGS);
}

static bool has_drag(const struct rb_feature_facts *facts)
{
	return has_elements(facts, RB_FEATURE_DRAG);
}

static bool has_other_elements(const struct rb_feature_facts *facts)
{
	return has_elements(facts, RB_FEATURE_ELEMENTS);
}

static bool has_field(const struct rb_feature_facts *facts)
{
	return facts->moves && facts->scene->field_count > 0;
}

static bool has_gravitation(const struct rb_feature_facts *facts)
{
	return facts->attracted;
}

static bool has_driven(const struct rb_feature_facts *facts)
{
	return facts->driven;
}

static bool has_joints(const struct rb_feature_facts *facts)
{
	return facts->joints;
}

static const struct rb_feature_row rows[] = {
	{RB_FEATURE_GRAVITY, "gravity", has_gravity, "the same acceleration on every moving body",
         "'gravity' is zero or nothing moves"},
	{RB_FEATURE_GRAVITY_FORCE, "gravity_force", has_gravity_force,
         "the same force on every moving body", "'gravity_force' is not given"},
	{RB_FEATURE_FORCES, "forces", has_forces, "forces of bodies' lists",
         "no body has 'forces'"},
	{RB_FEATURE_ROTATION, "rotation", has_rotation,
         "orientation and angular velocity of bodies",
         "nothing turns at the start and nothing could turn a body later"},
	{RB_FEATURE_GYROSCOPIC, "gyroscopic", has_gyroscopic,
         "the axis of a turning body with unequal principal moments wanders",
         "no turning body has unequal principal moments"},
	{RB_FEATURE_OFF_CENTER, "off_center", has_off_center,
         "centres of mass off the object's origin",
         "every centre of mass is at its object's origin"},
	{RB_FEATURE_CONTACT, "contact", has_contact,
         "bodies that could touch: search, gaps, impulses", "no two bodies could touch"},
	{RB_FEATURE_FRICTION, "friction", has_friction, "friction of materials that could meet",
         "no materials with friction could meet"},
	{RB_FEATURE_RESTITUTION, "restitution", has_restitution,
         "restitution of materials that could meet", "no materials with restitution could meet"},
	{RB_FEATURE_FILTERS, "filters", has_filters, "collision filters by group",
         "no body has 'collides_with'"},
	{RB_FEATURE_HOOK_STEP, "on_step", has_hook_step, "the scene's callback of every step",
         "the scene has no 'on_step'"},
	{RB_FEATURE_HOOK_COLLISION, "on_collision", has_hook_collision,
         "the scene's callback of every impact", "the scene has no 'on_collision'"},
	{RB_FEATURE_EVENTS, "events", has_events,
         "impacts are kept for the recording and for callbacks",
         "the recording has no \"events\" and the scene no 'on_collision' or 'on_transition'"},
	{RB_FEATURE_PUSHES, "pushes", has_pushes, "forces that callbacks apply",
         "the scene has no callback that could push"},
	{RB_FEATURE_SPRINGS, "springs", has_springs, "springs and dampers between bodies",
         "the scene has no 'spring'"},
	{RB_FEATURE_DRAG, "drag", has_drag, "drag on every moving body",
         "the scene has no 'drag', or nothing moves"},
	{RB_FEATURE_FIELD, "field", has_field, "forces that functions of the scene return",
         "the scene has no 'field', or nothing moves"},
	{RB_FEATURE_DRIVEN, "driven", has_driven, "bodies that a function of time moves",
         "no body has 'motion'"},
	{RB_FEATURE_HOOK_TRANSITION, "on_transition", has_hook_transition,
         "the scene's callback of every transition", "the scene has no 'on_transition'"},
	{RB_FEATURE_ELEMENTS, "elements", has_other_elements, "other forces by calls of their own",
         "the scene has none"},
	{RB_FEATURE_GRAVITATION, "gravitation", has_gravitation, "bodies attract each other",
         "the world has no 'gravitation', or nothing is attracted"},
	{RB_FEATURE_JOINTS, "joints", has_joints, "joints between bodies or with the world",
         "the scene has no 'joint'"},
};

const struct rb_feature_row *rb_feature_rows(int *count)
{
	*count = (int)(sizeof rows / sizeof rows[0]);
	return rows;
}

/* True if both belong to one class. */
static bool alike(const struct rb_body_def *a, const struct rb_body_def *b)
{
	return a->material == b->material && a->is_static == b->is_static &&
	       rb_body_is_driven(a) == rb_body_is_driven(b) &&
	       rb_body_collides(a) == rb_body_collides(b) &&
	       rb_body_group_bit(a) == rb_body_group_bit(b);
}

/* Classes of the scene's bodies; -1: more than KINDS_MAX. */
static int find_kinds(const struct rb_scene *scene, struct kind kinds[KINDS_MAX])
{
	int count = 0;

	for (int i = 0; i < scene->body_count; i++) {
		int k = 0;

		while (k < count && !alike(kinds[k].body, &scene->bodies[i]))
			k++;
		if (k == KINDS_MAX)
			return -1;
		if (k == count)
			kinds[count++] = (struct kind){.body = &scene->bodies[i]};
		else
			kinds[k].several = true;
	}
	return count;
}

/*
 * Sets can_touch, friction, restitution from pairs of classes; a class meets itself only if it has
 * several bodies.
 */
static void see_pairs(struct rb_feature_facts *facts, const struct rb_pair_material *pair)
{
	const struct rb_scene *scene = facts->scene;
	struct kind kinds[KINDS_MAX];
	const int count = find_kinds(scene, kinds);

	if (count < 0) {
		facts->can_touch = facts->friction = facts->restitution = true;
		return;
	}
	for (int a = 0; a < count; a++) {
		for (int b = a; b < count; b++) {
			if ((a == b && !kinds[a].several) ||
			    !rb_bodies_can_touch(kinds[a].body, kinds[b].body))
				continue;
			RB_ASSERT(kinds[a].body->material < scene->material_count);
			RB_ASSERT(kinds[b].body->material < scene->material_count);
			const struct rb_pair_material *p =
				&pair[kinds[a].body->material * scene->material_count +
			              kinds[b].body->material];
			facts->can_touch = true;
			facts->friction = facts->friction || p->friction > 0;
			facts->restitution = facts->restitution || p->restitution > 0;
		}
	}
}

/* True for a torque, or a force whose line of action misses the centre of mass. */
static bool twists(const struct rb_force_def *force, rb_vec3 center_of_mass)
{
	if (rb_vec3_max_abs(force->torque) > 0)
		return true;
	return !isnan(force->point.x) && rb_vec3_max_abs(force->vector) > 0 &&
	       rb_vec3_max_abs(rb_vec3_sub(force->point, center_of_mass)) > 0;
}

/* True if the element can exert a torque on some free body. */
static bool is_turned_by(const struct rb_scene *scene, const struct rb_element_kind *kind,
                         const void *row)
{
	int id[2];

	if (!kind->turns)
		return false;
	if (kind->ends) {
		kind->ends(row, id);
		return (rb_body_is_free(&scene->bodies[id[0]]) && kind->turns(scene, row, id[0])) ||
		       (rb_body_is_free(&scene->bodies[id[1]]) && kind->turns(scene, row, id[1]));
	}
	for (int i = 0; i < scene->body_count; i++)
		if (rb_body_is_free(&scene->bodies[i]) && kind->turns(scene, row, i))
			return true;
	return false;
}

/* Sets `torque` if an element turns a body. */
static void see_elements(struct rb_feature_facts *facts)
{
	for (int place = 0; place < rb_element_kind_count; place++)
		for (int k = 0; k < facts->scene->elements[place].count && !facts->torque; k++)
			facts->torque = is_turned_by(
				facts->scene, rb_element_kinds[place],
				rb_scene_element(facts->scene, rb_element_kinds[place], k));
}

/* True if some free body is attracted by another body. */
static bool is_attracted(const struct rb_scene *scene)
{
	int attractors = 0, free = 0, inert = 0;

	if (!scene->world.gravitation.given)
		return false;
	for (int i = 0; i < scene->body_count; i++) {
		const bool attracts = rb_body_attracts_by(scene, &scene->bodies[i]) > 0;
		const bool is_free = rb_body_is_free(&scene->bodies[i]);

		attractors += attracts;
		free += is_free;
		inert += is_free && !attracts;
	}
	/* one that attracts alone is attracted by nobody */
	return free > 0 && (attractors > 1 || (attractors == 1 && inert > 0));
}

/* Sets `joints` and whether one of them can turn a body. */
static void see_joints(struct rb_feature_facts *facts)
{
	facts->joints = facts->scene->joint_count > 0;
	for (int k = 0; k < facts->scene->joint_count; k++)
		facts->joints_turn = facts->joints_turn ||
		                     rb_joint_turns(facts->scene, &facts->scene->joints[k]);
}

/* True if the tensor, for unit mass, is not a multiple of 1. */
static bool has_unequal_moments(const struct rb_scene *scene, const struct rb_body_def *body)
{
	if (body->shape.kind == RB_SHAPE_SPHERE && !body->inertia)
		return false;
	const rb_mat3 inertia = rb_body_inertia(scene, body, 1);

	return !rb_inertia_is_scalar(&inertia);
}

struct rb_feature_facts rb_feature_facts_of(const struct rb_scene *scene,
                                            const struct rb_pair_material *pair)
{
	struct rb_feature_facts facts = {.scene = scene};

	for (int i = 0; i < scene->body_count; i++) {
		const struct rb_body_def *body = &scene->bodies[i];

		facts.filters = facts.filters || body->filters;
		facts.driven = facts.driven || rb_body_is_driven(body);
		facts.driven_turns = facts.driven_turns ||
		                     (rb_body_is_driven(body) && body->motion_turns);
		if (!rb_body_is_free(body))
			continue;
		facts.moves = true;
		facts.spins = facts.spins || rb_vec3_max_abs(body->angular_velocity) > 0;
		facts.off_center = facts.off_center || rb_vec3_max_abs(body->center_of_mass) > 0;
		facts.angular = facts.angular || body->shape.kind != RB_SHAPE_SPHERE;
		facts.unequal = facts.unequal || has_unequal_moments(scene, body);
		facts.forces = facts.forces || body->force_count > 0;
		for (int f = 0; f < body->force_count; f++)
			facts.torque = facts.torque || twists(&scene->forces[body->force_first + f],
			                                      body->center_of_mass);
	}
	see_elements(&facts);
	facts.attracted = is_attracted(scene);
	see_joints(&facts);
	if (facts.moves)
		see_pairs(&facts, pair);
	return facts;
}

rb_features rb_features_of(const struct rb_scene *scene, const struct rb_pair_material *pair)
{
	const struct rb_feature_facts facts = rb_feature_facts_of(scene, pair);
	rb_features features = 0;

	for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
		if (rows[i].present(&facts))
			features |= rows[i].bit;
	return features;
}
