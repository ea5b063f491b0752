# SPDX-License-Identifier: MIT
# A verb of tools/sample: how many bodies a scene has.
most=4

add()
{
	cat >src/app/count.h <<'END'
/* SPDX-License-Identifier: MIT */
/* `rbsim count`: how many bodies a scene has, and how many of them move. Gives the exit status. */
#ifndef RB_APP_COUNT_H
#define RB_APP_COUNT_H

#include "app/options.h"

int rb_count_main(const struct rb_options *options);

#endif
END
	cat >src/app/count.c <<'END'
/* SPDX-License-Identifier: MIT */
#include "app/count.h"

#include "app/common.h"
#include "base/visible.h"

int rb_count_main(const struct rb_options *options)
{
	struct rb_loaded loaded;
	struct rb_error err;
	int exit_code = 0;

	if (rb_loaded_init(&loaded, options, &err))
		exit_code = rb_app_fail_scene(options, &loaded, &err);
	else
		rb_print(stdout, "%d %s, of which %d %s\n", loaded.scene.body_count,
		         rb_text_plural((uint64_t)loaded.scene.body_count, "body", "bodies"),
		         loaded.model->body_count,
		         rb_text_plural((uint64_t)loaded.model->body_count, "moves", "move"));
	rb_loaded_release(&loaded);
	return rb_app_finish(options, exit_code);
}
END
	edit src/app/options.h 's|^	RB_VERB_COUNT$|	RB_VERB_CENSUS,\n&|'
	edit src/app/options.c 's/^	(VERB(RUN) |/	(VERB(CENSUS) | VERB(RUN) |/' \
		's|^	\[RB_VERB_METHODS\] = |	[RB_VERB_CENSUS] = {"count", "SCENE.lua", 1, "how many bodies a scene has", "rbsim count bounce.lua\\ta line\\n"},\n&|'
	edit src/app/main.c 's|^#include "app/console.h"|&\n#include "app/count.h"|' 's|^	\[RB_VERB_RUN\] = |	[RB_VERB_CENSUS] = rb_count_main,\n&|'
	place app/count app/render "how many bodies a scene has"
}

try()
{
	cat >three.lua <<'END'
world { duration = 1 }
plane { point = {0, 0, -9} }
sphere { radius = 1 }
sphere { radius = 1, position = {3, 0, 0} }
END
	[ "$("$rbsim" count three.lua)" = "3 bodies, of which 2 move" ] || fail "the sample verb is wrong"
	"$rbsim" --help | grep -q '^ *count ' || fail "it has no line in the help"
	"$rbsim" count --help | grep -q 'rbsim count bounce.lua' || fail "it has no examples"
	"$rbsim" --print-tables bash | grep -q '\<count\>' || fail "the completion does not have it"
	"$rbsim" cuont three.lua 2>&1 | grep -q "did you mean 'count'" || fail "a near name has no advice"
	"$rbsim" count three.lua --threads 2 2>&1 | grep -q "threads" || fail "it takes options of other verbs"
	echo 'sphere { radius = -1 }' >bad.lua
	status=0
	"$rbsim" count bad.lua >out 2>err || status=$?
	[ $status -eq 65 ] && grep -q "bad.lua:1: sphere: 'radius'" err || fail "a wrong scene is not refused ($status)"
}
