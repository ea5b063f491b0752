/* SPDX-License-Identifier: MIT */
/*
 * A case says itself, by the choices of its parameters, which runs it asks for: parameters of its
 * own span the bases (all combinations), those with the names of variations are applied to each
 * base one at a time. So the list of runs needs no second file, and a case that lacks a variation
 * states why in that parameter's help.
 */
#include "app/cases.h"

#include <ctype.h>
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/common.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/program.h"
#include "script/nearest.h"

/* PATH_BYTES: of a path. VALUE_BYTES: of one choice. */
enum { PATH_BYTES = 4096, VALUE_BYTES = 64 };

/* ---- which files ---- */

/* Finds the folder with the cases: as lua/ is found, beside the program. */
static bool find_folder(const struct rb_options *options, char folder[PATH_BYTES])
{
	static const char *const beside[] = {"../scenes/verify", "../../scenes/verify",
	                                     "../share/rbsim/scenes/verify"};
	const char *given = options->scenes ? options->scenes : getenv("RBSIM_VERIFY_PATH");

	if (given && *given) {
		snprintf(folder, PATH_BYTES, "%s", given);
		return access(folder, R_OK) == 0;
	}
	snprintf(folder, PATH_BYTES, "%s", beside[2]);
	for (size_t i = 0; i < sizeof beside / sizeof *beside; i++)
		if (rb_program_beside(beside[i], folder, PATH_BYTES) && access(folder, R_OK) == 0)
			return true;
	return false;
}

/* For qsort. */
static int by_name(const void *a, const void *b)
{
	const struct rb_case *const first = a, *const second = b;

	return strcmp(first->name, second->name);
}

/*
 * Whether a file is a case: S03_zeno.lua: a capital, digits, what it is. Others are parts of cases.
 */
static bool is_case(const char *name)
{
	const size_t size = strlen(name);

	return size > 4 && isupper((unsigned char)name[0]) && isdigit((unsigned char)name[1]) &&
	       strcmp(name + size - 4, ".lua") == 0;
}

/* Fails. */
static enum rb_status no_memory(struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot list the cases: out of memory");
}

/* Appends a case without its runs. */
static enum rb_status add_case(struct rb_cases *cases, const char *folder, const char *file,
                               struct rb_error *err)
{
	char path[PATH_BYTES];
	const size_t count = (size_t)cases->count;
	struct rb_case *const grown = rb_memory_grow(cases->cases, count, count + 1,
	                                             sizeof *cases->cases);

	if (!grown)
		return no_memory(err);
	cases->cases = grown;
	struct rb_case *const added = &grown[cases->count++];
	snprintf(path, sizeof path, "%.3800s/%.255s", folder, file);
	added->path = rb_memory_copy_text(path);
	added->name = rb_memory_copy_text(file);
	if (!added->path || !added->name)
		return no_memory(err);
	added->name[strlen(file) - 4] = '\0';
	return RB_OK;
}

/* Lists the cases of the folder, by name. */
static enum rb_status list_cases(struct rb_cases *cases, const struct rb_options *options,
                                 struct rb_error *err)
{
	char folder[PATH_BYTES];
	enum rb_status status = RB_OK;
	DIR *const open = find_folder(options, folder) ? opendir(folder) : NULL;

	if (!open)
		return RB_FAIL(err, RB_ERR_INPUT,
		               "cannot find the cases: no folder '%s' (--scenes names another)",
		               folder);
	for (const struct dirent *entry; !status && (entry = readdir(open));)
		if (is_case(entry->d_name))
			status = add_case(cases, folder, entry->d_name, err);
	closedir(open);
	if (!status && cases->count == 0)
		return RB_FAIL(err, RB_ERR_INPUT,
		               "cannot find the cases: none in '%s' (S01_free_fall.lua, for one)",
		               folder);
	if (!status)
		qsort(cases->cases, (size_t)cases->count, sizeof *cases->cases, by_name);
	return status;
}

/* ---- which of them ---- */

/* Whether a name begins with a word, whatever their case. */
static bool begins(const char *name, const char *word)
{
	return strncasecmp(name, word, strlen(word)) == 0;
}

/* Fails with the nearest name where no case begins with a word. */
static enum rb_status check_word(const struct rb_cases *cases, const char *word,
                                 struct rb_error *err)
{
	struct rb_nearest nearest = rb_nearest_to(word);
	char hint[96];

	for (int i = 0; i < cases->count; i++)
		if (begins(cases->cases[i].name, word))
			return RB_OK;
	for (int i = 0; i < cases->count; i++) {
		const char *const name = cases->cases[i].name;
		rb_nearest_offer(&nearest, name, strlen(name));
		rb_nearest_offer(&nearest, name, strcspn(name, "_"));
	}
	return RB_FAIL(err, RB_ERR_USAGE, "unknown case '%s'%s: there are %s to %s", word,
	               rb_nearest_hint(&nearest, hint), cases->cases[0].name,
	               cases->cases[cases->count - 1].name);
}

/* Frees a case with its runs. */
static void case_release(struct rb_case *one)
{
	for (int i = 0; i < one->run_count; i++) {
		for (int k = 0; k < one->runs[i].param_count; k++)
			rb_memory_free((char *)(uintptr_t)one->runs[i].params[k]);
		rb_memory_free(one->runs[i].params);
		rb_memory_free(one->runs[i].label);
	}
	rb_memory_free(one->runs);
	rb_memory_free(one->path);
	rb_memory_free(one->name);
	rb_memory_free(one->title);
	rb_memory_free(one->left_out);
	*one = (struct rb_case){0};
}

/* Keeps the cases that the command line names, in their order; all where it names none. */
static enum rb_status choose(struct rb_cases *cases, const struct rb_options *options,
                             struct rb_error *err)
{
	int kept = 0;

	for (int i = 0; i < options->word_count; i++) {
		const enum rb_status status = check_word(cases, options->words[i], err);
		if (status)
			return status;
	}
	for (int i = 0; i < cases->count && options->word_count > 0; i++) {
		bool wanted = false;
		for (int k = 0; k < options->word_count; k++)
			wanted = wanted || begins(cases->cases[i].name, options->words[k]);
		if (wanted) {
			const struct rb_case one = cases->cases[i];
			cases->cases[i] = cases->cases[kept];
			cases->cases[kept++] = one;
		}
	}
	if (options->word_count > 0) {
		for (int i = kept; i < cases->count; i++)
			case_release(&cases->cases[i]);
		cases->count = kept;
	}
	return RB_OK;
}

/* ---- which runs ---- */

/* What of a case a quick run takes. */
enum quick { QUICK_NONE, QUICK_BASE, QUICK_MORE, QUICK_ALL };

/* State while the runs of a case are listed. */
struct plan {
	struct rb_case *one;
	const struct rb_scene *scene;
	bool only_quick;
	enum quick quick;
	const char **params; /* the base that is being listed: K=V of the case's own parameters */
	int param_count;
	struct rb_error *err;
};

/* Whether a parameter is one of the variations that every case may have. */
static bool is_variation(const struct rb_param_def *param)
{
	static const char *const names[] = {"time_step", "frame_rate", "turn",
	                                    "shift",     "harmless",   "zero_field"};

	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		if (strcmp(param->name, names[i]) == 0)
			return true;
	return false;
}

/* Whether a parameter is one of the case's own that spans bases. */
static bool is_own(const struct rb_param_def *param)
{
	return param->choices && !is_variation(param) && strcmp(param->name, "quick") != 0;
}

/* The k-th of "a, b, c"; false: there are fewer. */
static bool choice(const struct rb_param_def *param, int k, char out[VALUE_BYTES])
{
	const char *at = param->choices;

	RB_ASSERT(k >= 0);
	for (; k > 0 && at; k--) {
		at = strchr(at, ',');
		at = at ? at + 2 : NULL;
	}
	if (!at)
		return false;
	snprintf(out, VALUE_BYTES, "%.*s", (int)strcspn(at, ","), at);
	return true;
}

/* NAME=VALUE, to be freed; NULL: no memory. */
static const char *assignment(const struct rb_param_def *param, const char *value)
{
	char text[256];

	snprintf(text, sizeof text, "%s=%s", param->name, value);
	return rb_memory_copy_text(text);
}

/* Appends a run: the base at hand, with one more parameter unless that is NULL. */
static enum rb_status add_run(struct plan *plan, const struct rb_param_def *varied,
                              const char *value)
{
	struct rb_case *const one = plan->one;
	const size_t count = (size_t)one->run_count;
	struct rb_case_run *const grown = rb_memory_grow(one->runs, count, count + 1,
	                                                 sizeof *one->runs);
	char label[256] = "";
	bool right = true;

	if (!grown)
		return no_memory(plan->err);
	one->runs = grown;
	struct rb_case_run *const run = &grown[one->run_count++];
	run->params = rb_memory_take((size_t)plan->param_count + 1, sizeof *run->params);
	if (!run->params)
		return no_memory(plan->err);
	for (int i = 0; i < plan->param_count; i++)
		run->params[run->param_count++] = rb_memory_copy_text(plan->params[i]);
	if (varied)
		run->params[run->param_count++] = assignment(varied, value);
	for (int i = 0; i < run->param_count; i++) {
		const size_t used = strlen(label);
		right = right && run->params[i];
		if (right)
			snprintf(label + used, sizeof label - used, "%s%s", i > 0 ? " " : "",
			         run->params[i]);
	}
	run->label = rb_memory_copy_text(*label ? label : "base");
	return right && run->label ? RB_OK : no_memory(plan->err);
}

/*
 * Whether a variation is run: in a quick run the oblique rotation, one other time step and the zero
 * field, for some cases.
 */
static bool wanted(const struct plan *plan, const struct rb_param_def *param, const char *value,
                   int nth)
{
	if (!plan->only_quick)
		return true;
	if (plan->quick != QUICK_MORE)
		return false;
	if (strcmp(param->name, "turn") == 0)
		return strcmp(value, "2") == 0;
	return strcmp(param->name, "zero_field") == 0 ||
	       (strcmp(param->name, "time_step") == 0 && nth == 0);
}

/* Appends the base at hand and its variations. */
static enum rb_status add_variations(struct plan *plan)
{
	char value[VALUE_BYTES];
	enum rb_status status = add_run(plan, NULL, NULL);

	for (int i = 0; i < plan->scene->param_count; i++) {
		const struct rb_param_def *const param = &plan->scene->params[i];
		if (!is_variation(param) || !param->choices)
			continue;
		int nth = 0;
		for (int k = 0; !status && choice(param, k, value); k++)
			if (strcmp(value, param->default_text) != 0 &&
			    wanted(plan, param, value, nth++))
				status = add_run(plan, param, value);
	}
	return status;
}

/* Appends all combinations of the case's own parameters from the i-th on. */
static enum rb_status add_bases(struct plan *plan, int i)
{
	char value[VALUE_BYTES];
	enum rb_status status = RB_OK;

	RB_ASSERT(i >= 0);
	while (i < plan->scene->param_count && !is_own(&plan->scene->params[i]))
		i++;
	if (i == plan->scene->param_count)
		return add_variations(plan);
	const struct rb_param_def *const param = &plan->scene->params[i];
	for (int k = 0; !status && choice(param, k, value); k++) {
		if (plan->only_quick && plan->quick != QUICK_ALL &&
		    strcmp(value, param->default_text) != 0)
			continue;
		const char *const text = assignment(param, value);
		if (!text)
			return no_memory(plan->err);
		plan->params[plan->param_count++] = text;
		status = add_bases(plan, i + 1);
		plan->param_count--;
		rb_memory_free((char *)(uintptr_t)text);
	}
	return status;
}

/* What the case's parameter `quick` says. */
static enum quick quick_of(const char *text)
{
	static const char *const names[] = {"none", "base", "more", "all"};

	for (int i = 0; i < 4; i++)
		if (strcmp(text, names[i]) == 0)
			return (enum quick)i;
	return QUICK_BASE;
}

/* Reads the parameters that are about the case and not about its physics. */
static enum rb_status read_params(struct plan *plan)
{
	struct rb_case *const one = plan->one;
	char left_out[1024] = "";

	one->limit_s = 60;
	plan->quick = QUICK_BASE;
	for (int i = 0; i < plan->scene->param_count; i++) {
		const struct rb_param_def *const param = &plan->scene->params[i];
		const size_t used = strlen(left_out);
		if (strcmp(param->name, "processor_seconds") == 0)
			one->limit_s = param->value;
		else if (strcmp(param->name, "quick") == 0)
			plan->quick = quick_of(param->default_text);
		else if (is_variation(param) && param->choices && !strchr(param->choices, ','))
			snprintf(left_out + used, sizeof left_out - used, "%s%s: %s",
			         used > 0 ? "; " : "", param->name, param->help);
	}
	one->left_out = rb_memory_copy_text(left_out);
	one->title = rb_memory_copy_text(plan->scene->world.title ? plan->scene->world.title : "");
	return one->left_out && one->title ? RB_OK : no_memory(plan->err);
}

/*
 * Loads the case and lists its runs. A scene that does not load has the runs that its parameters
 * ask for as far as they were read: they report why.
 */
static enum rb_status plan_runs(struct rb_case *one, const struct rb_options *options,
                                struct rb_error *err)
{
	const struct rb_script_options script_options = {.path = one->path};
	struct plan plan = {.one = one, .only_quick = options->quick, .err = err};
	struct rb_script *script = NULL;
	struct rb_scene scene = {0};
	struct rb_mistakes mistakes = {0};
	struct rb_error refusal;
	enum rb_status status = rb_script_load(&script, &scene, &mistakes, &script_options,
	                                       &refusal);

	if (status == RB_ERR_MEMORY || status == RB_ERR_INPUT) {
		*err = refusal;
	} else {
		plan.scene = &scene;
		plan.params = rb_memory_take((size_t)scene.param_count + 1, sizeof *plan.params);
		status = plan.params ? read_params(&plan) : no_memory(err);
		/* named on the command line, a case runs in any event */
		if (options->word_count > 0 && plan.quick == QUICK_NONE)
			plan.quick = QUICK_BASE;
		if (!status && !(plan.only_quick && plan.quick == QUICK_NONE))
			status = add_bases(&plan, 0);
		rb_memory_free(plan.params);
	}
	rb_script_destroy(script);
	rb_scene_release(&scene);
	rb_mistakes_release(&mistakes);
	return status;
}

enum rb_status rb_cases_init(struct rb_cases *cases, const struct rb_options *options,
                             struct rb_error *err)
{
	int kept = 0;

	*cases = (struct rb_cases){0};
	enum rb_status status = list_cases(cases, options, err);
	if (!status)
		status = choose(cases, options, err);
	for (int i = 0; !status && i < cases->count; i++)
		status = plan_runs(&cases->cases[i], options, err);
	if (status)
		return status;
	for (int i = 0; i < cases->count; i++) {
		if (cases->cases[i].run_count > 0)
			cases->cases[kept++] = cases->cases[i];
		else
			case_release(&cases->cases[i]);
	}
	cases->count = kept;
	return RB_OK;
}

void rb_cases_release(struct rb_cases *cases)
{
	for (int i = 0; i < cases->count; i++)
		case_release(&cases->cases[i]);
	rb_memory_free(cases->cases);
	*cases = (struct rb_cases){0};
}
