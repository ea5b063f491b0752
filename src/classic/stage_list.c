/* SPDX-License-Identifier: MIT */
/*
 * The list of stages is built once for a scene, so that the substep runs through function pointers
 * without testing features. The same table prints what `rbsim check` says.
 */
#include "classic/stage_list.h"

#include "base/error.h"
#include "model/features.h"
#include "classic/contact.h"
#include "step/flow.h"
#include "step/force_stages.h"
#include "step/gap.h"

/* Order of a substep: forces, reactions last of them, then motion, then the gaps. */
static const struct rb_stage *const all_stages[] = {
	&rb_stage_gravity,   &rb_stage_gravity_force,     &rb_stage_applied,
	&rb_stage_pushes,    &rb_stage_look_ahead,        &rb_stage_reactions,
	&rb_stage_translate, &rb_stage_rotate_gyroscopic, &rb_stage_rotate,
	&rb_stage_gap,
};
enum { ALL_STAGES = sizeof all_stages / sizeof all_stages[0] };

const struct rb_stage *const *rb_stage_list_all(int *count)
{
	*count = ALL_STAGES;
	return all_stages;
}

bool rb_stage_list_has(const struct rb_stage *stage, rb_features features)
{
	/* the general rotation takes the place of the plain one */
	if (stage == &rb_stage_rotate && (features & RB_FEATURE_GYROSCOPIC))
		return false;
	return rb_stage_is_needed(stage, features);
}

void rb_stage_list_build(struct rb_stage_list *plan, rb_features features)
{
	*plan = (struct rb_stage_list){0};
	for (int k = 0; k < ALL_STAGES; k++)
		if (rb_stage_list_has(all_stages[k], features))
			plan->stage[plan->count++] = all_stages[k];
	RB_ASSERT(plan->count <= RB_STAGE_LIST_MAX);
}

void rb_stage_list_run(const struct rb_stage_list *plan, struct rb_pass *pass)
{
	pass->worst = -1;
	for (int k = 0; k < plan->count && pass->worst < 0; k++)
		plan->stage[k]->run(pass);
}

/*
 * Bytes of the state's columns, three copies of which a world keeps (two of located and classic
 * ones without contact).
 */
static size_t state_bytes(const struct rb_model *model)
{
	int count = 0;
	size_t bytes = 0;
	const struct rb_state_column *column = rb_state_columns(&count);

	for (int k = 0; k < count; k++)
		if (column[k].feature == 0 || (model->features & column[k].feature))
			bytes += (size_t)column[k].columns * sizeof(double) *
			         (size_t)model->body_count;
	return bytes;
}

/* Copies of the state that a world keeps. */
static int state_copies(const struct rb_model *model)
{
	return (model->features & RB_FEATURE_CONTACT) || model->method == RB_METHOD_STEPPED ? 3 : 2;
}

void rb_stage_list_print_features(const struct rb_model *model, FILE *to)
{
	int count = 0;
	const struct rb_feature_row *row = rb_feature_rows(&count);

	fputs("features\n", to);
	for (int k = 0; k < count; k++) {
		const bool on = model->features & row[k].bit;

		fprintf(to, "  %c %-16s %s\n", on ? '+' : '-', row[k].name,
		        on ? row[k].help : row[k].absent);
	}
}

/* Why a stage is not in the list. */
static const char *why_left_out(const struct rb_stage *stage, rb_features features)
{
	int count = 0;
	const struct rb_feature_row *row = rb_feature_rows(&count);

	if (stage == &rb_stage_rotate && (features & RB_FEATURE_GYROSCOPIC))
		return "rotate_gyroscopic takes its place";
	for (int k = 0; k < count; k++)
		if (row[k].bit & stage->need)
			return row[k].absent;
	return "";
}

void rb_stage_list_print(const struct rb_model *model, FILE *to)
{
	int count = 0;
	const struct rb_state_column *column = rb_state_columns(&count);

	if (model->method == RB_METHOD_CLASSIC)
		fputs("stages of a substep\n", to);
	for (int k = 0; k < ALL_STAGES && model->method == RB_METHOD_CLASSIC; k++) {
		const bool on = rb_stage_list_has(all_stages[k], model->features);

		fprintf(to, "  %c %-18s %s\n", on ? '+' : '-', all_stages[k]->name,
		        on ? all_stages[k]->what : why_left_out(all_stages[k], model->features));
	}
	fputs("columns of the state\n", to);
	for (int k = 0; k < count; k++) {
		const bool on = column[k].feature == 0 || (model->features & column[k].feature);

		fprintf(to, "  %c %-16s %d x %d doubles, %s: %s\n", on ? '+' : '-', column[k].name,
		        on ? model->body_count : 0, column[k].columns, column[k].unit,
		        column[k].what);
	}
	fprintf(to, "  %zu bytes, %d copies\n", state_bytes(model), state_copies(model));
}
