/* SPDX-License-Identifier: MIT */
#include "app/methods.h"

#include "app/common.h"
#include "app/json.h"
#include "base/visible.h"

static const struct {
	const char *name, *what, *good_for, *mind;
} methods[] = {
	{"located",
         "every body flies on its own clock from event to event; impacts are located to rounding "
         "and lasting contacts "
         "end where they end",
         "impacts that must be right, gases, long runs; springs, drag, fields and driven bodies",
         "touching bodies are solved together, which costs much where they are many; one thread"},
	{"classic", "one step for all; a step that ends in an overlap is taken back and halved",
         "lectures; a baseline for every other method",
         "errors fall with the first power of time_step; heaps cost much; no springs, drag, fields "
         "or driven bodies"},
	{"stepped",
         "equal steps; what touches within one is solved together, to a residual, so that no gap "
         "closes beyond the "
         "tolerance; a step that fails is taken back and halved",
         "heaps, stacks, towers of any shapes and masses",
         "impacts are at ends of steps: errors fall with the first power of time_step; springs "
         "that a step does not "
         "resolve lose their oscillation"},
	{"auto",
         "located, but stepped while events come too densely, or motion is too fast, to locate",
         "whoever does not want to choose (the default)",
         "how long was stepped stands in the summary and in the recording"},
};
static const struct {
	const char *name, *what;
} rollbacks[] = {
	{"selective", "only the bodies concerned are restored and go on in shorter steps (the "
                      "default); stepped, with those they "
                      "could meet; located, none have to be"},
	{"global", "the whole scene is restored, as first described; located, at every event, for "
                   "the same bits"},
	{"none", "nothing is restored: with classic steps the tolerance is reported, not promised"},
};

int rb_methods_main(const struct rb_options *options)
{
	const int method_count = sizeof methods / sizeof *methods;
	const int rollback_count = sizeof rollbacks / sizeof *rollbacks;

	if (options->json) {
		struct rb_json json = {.file = stdout};
		rb_json_open(&json, NULL, '{');
		rb_json_open(&json, "methods", '[');
		for (int i = 0; i < method_count; i++) {
			rb_json_open(&json, NULL, '{');
			rb_json_text(&json, "name", methods[i].name);
			rb_json_text(&json, "what", methods[i].what);
			rb_json_text(&json, "good_for", methods[i].good_for);
			rb_json_text(&json, "mind", methods[i].mind);
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
		rb_json_close(&json, '}');
		putchar('\n');
		return rb_app_finish(options, 0);
	}
	rb_print(stdout, "method = ... (or --method)\n");
	for (int i = 0; i < method_count; i++)
		rb_print(stdout, "  %-10s %s\n  %-10s good for: %s\n  %-10s mind: %s\n",
		         methods[i].name, methods[i].what, "", methods[i].good_for, "",
		         methods[i].mind);
	rb_print(stdout, "rollback = ... (or --rollback)\n");
	for (int i = 0; i < rollback_count; i++)
		rb_print(stdout, "  %-10s %s\n", rollbacks[i].name, rollbacks[i].what);
	return rb_app_finish(options, 0);
}
