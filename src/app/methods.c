/* SPDX-License-Identifier: MIT */
#include "app/methods.h"

#include "app/common.h"
#include "app/json.h"
#include "base/visible.h"
#include "model/descriptor.h"

static const struct {
	const char *name, *what;
} rollbacks[] = {
	{"selective", "only the bodies concerned are restored and continue in shorter steps (the "
                      "default); stepped, with those they "
                      "could meet; located, none have to be"},
	{"global", "the whole scene is restored, as first described; located, at every event, for "
                   "the same bits"},
	{"none", "nothing is restored: with classic steps the tolerance is reported, not promised"},
};

int rb_methods_main(const struct rb_options *options)
{
	const int rollback_count = sizeof rollbacks / sizeof *rollbacks;

	if (options->json) {
		struct rb_json json = {.file = stdout};
		rb_json_open(&json, NULL, '{');
		rb_json_open(&json, "methods", '[');
		for (int i = 0; i < RB_METHOD_KIND_COUNT; i++) {
			rb_json_open(&json, NULL, '{');
			rb_json_text(&json, "name", rb_methods[i]->name);
			rb_json_text(&json, "what", rb_methods[i]->what);
			rb_json_text(&json, "good_for", rb_methods[i]->good_for);
			rb_json_text(&json, "mind", rb_methods[i]->mind);
			rb_json_close(&json, '}');
		}
		rb_json_close(&json, ']');
		rb_json_open(&json, "rollbacks", '[');
		for (int i = 0; i < rollback_count; i++) {
			rb_json_open(&json, NULL, '{');
			rb_json_text(&json, "name", rollbacks[i].name);
			rb_json_text(&json, "what", rollbacks[i].what);
			rb_json_close(&json, '}');
		}
		rb_json_close(&json, ']');
		rb_json_count(&json, "exit_status", 0);
		rb_json_close(&json, '}');
		putchar('\n');
		return rb_app_finish(options, 0);
	}
	rb_print(stdout, "method = ... (or --method)\n");
	for (int i = 0; i < RB_METHOD_KIND_COUNT; i++)
		rb_print(stdout, "  %-10s %s\n  %-10s good for: %s\n  %-10s mind: %s\n",
		         rb_methods[i]->name, rb_methods[i]->what, "", rb_methods[i]->good_for, "",
		         rb_methods[i]->mind);
	rb_print(stdout, "rollback = ... (or --rollback)\n");
	for (int i = 0; i < rollback_count; i++)
		rb_print(stdout, "  %-10s %s\n", rollbacks[i].name, rollbacks[i].what);
	return rb_app_finish(options, 0);
}
