/* SPDX-License-Identifier: MIT */
#include "app/export.h"

#include <inttypes.h>
#include <string.h>

#include "app/exported.h"
#include "app/json.h"
#include "base/error.h"
#include "base/visible.h"

static const struct rb_export_form *const forms[] = {&rb_export_csv, &rb_export_glb, &rb_export_vtk,
                                                     &rb_export_dump};
enum { FORM_COUNT = sizeof forms / sizeof *forms };

/* The form of --to, else that whose ending the output's name has. */
static const struct rb_export_form *form_of(const struct rb_options *options, struct rb_error *err)
{
	const char *const name = options->output ? options->output : "";
	const size_t size = strlen(name);

	const struct rb_export_form *wanted = NULL, *named = NULL;

	for (int k = 0; k < FORM_COUNT; k++) {
		const char *const ending = *forms[k]->ending ? forms[k]->ending : ".csv";
		if (options->form && strcmp(forms[k]->name, options->form) == 0)
			wanted = forms[k];
		if (size > strlen(ending) && strcmp(name + size - strlen(ending), ending) == 0)
			named = forms[k];
	}
	if (wanted && named && wanted != named) {
		(void)RB_FAIL(err, RB_ERR_USAGE, "option '--output': '%s' is a name for '--to' %s",
		              name, named->name);
		return NULL;
	}
	if (wanted || named)
		return wanted ? wanted : named;
	(void)RB_FAIL(err, RB_ERR_USAGE,
	              "'export' needs '--to' csv, glb, vtk or dump, or an '--output' that ends in "
	              ".csv, .glb, .pvd or .dump");
	return NULL;
}

/* The recording's name, here, without .h5 and with the ending of the form. */
static enum rb_status name_output(const struct rb_options *options,
                                  const struct rb_export_form *form, char out[RB_EXPORT_NAME_SIZE],
                                  struct rb_error *err)
{
	const char *const slash = strrchr(options->operand[0], '/');
	const char *const base = slash ? slash + 1 : options->operand[0];
	size_t size = strlen(base);

	if (options->output && strlen(options->output) < RB_EXPORT_NAME_SIZE) {
		snprintf(out, RB_EXPORT_NAME_SIZE, "%s", options->output);
		return RB_OK;
	}
	if (options->output || size + 16 >= RB_EXPORT_NAME_SIZE)
		return RB_FAIL(err, RB_ERR_CREATE, "the name '%s' is too long",
		               options->output ? options->output : base);
	if (size > 3 && strcmp(base + size - 3, ".h5") == 0)
		size -= 3;
	snprintf(out, RB_EXPORT_NAME_SIZE, "%.*s%s", (int)size, base, form->ending);
	return RB_OK;
}

static void tell(const struct rb_exported *exported, const struct rb_export_form *form)
{
	struct rb_json json = {.file = stdout};

	if (exported->options->json) {
		rb_json_open(&json, NULL, '{');
		rb_json_text(&json, "file", exported->file);
		rb_json_text(&json, "to", form->name);
		rb_json_open(&json, "outputs", '[');
		for (int i = 0; i < exported->output_count; i++)
			rb_json_text(&json, NULL, exported->outputs[i].name);
		rb_json_close(&json, ']');
		rb_json_count(&json, "frames", exported->reading->frame_count);
		rb_json_count(&json, "exit_status", 0);
		rb_json_close(&json, '}');
		putchar('\n');
	} else if (!exported->options->quiet) {
		for (int i = 0; i < exported->output_count; i++) {
			const struct rb_export_content *const c = &exported->outputs[i].content;
			rb_print(stdout, "%s: %" PRIu64 " %s\n", exported->outputs[i].name,
			         c->count, rb_text_plural(c->count, c->one, c->many));
		}
	}
}

int rb_export_main(const struct rb_options *options)
{
	struct rb_exported exported = {0};
	char name[RB_EXPORT_NAME_SIZE];
	struct rb_error err;
	const struct rb_export_form *const form = form_of(options, &err);
	enum rb_status status = form ? name_output(options, form, name, &err) : RB_ERR_USAGE;

	if (!status)
		status = rb_exported_open(&exported, options, form, &err);
	if (!status)
		status = form->write(&exported, name, &err);
	if (!status)
		tell(&exported, form);
	rb_exported_release(&exported);
	return rb_app_finish(options, status ? rb_app_refuse(options, &err) : 0);
}
