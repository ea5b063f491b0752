/* SPDX-License-Identifier: MIT */
/*
 * Keys stand for lines of the command language wherever that can say what they do, so that the
 * console, the socket and files of commands cannot drift apart. Only what needs the state of the
 * screen has an action of its own. The order is that of the help.
 */
#include "control/keys.h"

#include <stddef.h>

const struct rb_key_row rb_key_rows[] = {
	{' ', "space", RB_KEY_RUNS, "toggle", "play what is paused, pause what plays"},
	{RB_KEY_LEFT, "left", RB_KEY_SEEKS, "-1", "back by a hundredth of the run"},
	{RB_KEY_RIGHT, "right", RB_KEY_SEEKS, "1", "on by a hundredth of the run"},
	{RB_KEY_SHIFT_LEFT, "shift-left", RB_KEY_SEEKS, "-10", "back by a tenth of the run"},
	{RB_KEY_SHIFT_RIGHT, "shift-right", RB_KEY_SEEKS, "10", "on by a tenth of the run"},
	{RB_KEY_HOME, "Home", RB_KEY_RUNS, "seek 0", "the first frame"},
	{RB_KEY_END, "End", RB_KEY_ENDS, "",
         "the last frame; of a run that goes on: always its newest one"},
	{'.', ".", RB_KEY_RUNS, "step", "one frame on"},
	{',', ",", RB_KEY_RUNS, "back", "one frame back"},
	{'n', "n", RB_KEY_RUNS, "next collision", "the next frame with a collision"},
	{'p', "p", RB_KEY_RUNS, "previous collision", "the one before"},
	{'N', "N", RB_KEY_RUNS, "previous collision", "the same"},
	{'[', "[", RB_KEY_SCALES, "0.5", "half as fast"},
	{']', "]", RB_KEY_SCALES, "2", "twice as fast"},
	{'1', "1", RB_KEY_RUNS, "speed 1", "in true time"},
	{'g', "g", RB_KEY_TYPES, "seek ", "go to a time or a percentage"},
	{'c', "c", RB_KEY_TOGGLES_STOP, "", "stop at collisions, or not"},
	{'V', "V", RB_KEY_TOGGLES_VIEW, "", "pause or play one's own view only"},
	{'R', "R", RB_KEY_RUNS, "restart", "restart the simulation"},
	{'/', "/", RB_KEY_SEARCHES, "", "look for a body by a part of its name"},
	{'b', "b", RB_KEY_TYPES, "body ", "look at a body by its name"},
	{'f', "f", RB_KEY_FOLLOWS, "", "keep the body that is looked at in the middle, or none"},
	{'v', "v", RB_KEY_CAMERA, "", "the next camera of the scene"},
	{'a', "a", RB_KEY_RUNS, "camera all", "show all that moves, over the whole time"},
	{'+', "+", RB_KEY_RUNS, "camera zoom 1.25", "nearer"},
	{'-', "-", RB_KEY_RUNS, "camera zoom 0.8", "farther away"},
	{'h', "h", RB_KEY_RUNS, "camera orbit -10 0",
         "around what the camera looks at, to the left"},
	{'l', "l", RB_KEY_RUNS, "camera orbit 10 0", "to the right"},
	{'k', "k", RB_KEY_RUNS, "camera orbit 0 10", "over it"},
	{'j', "j", RB_KEY_RUNS, "camera orbit 0 -10", "under it"},
	{'s', "s", RB_KEY_RUNS, "snapshot", "write a picture of this frame"},
	{':', ":", RB_KEY_TYPES, "",
         "type a command; Tab completes it, up and down fetch earlier ones"},
	{'?', "?", RB_KEY_HELPS, "", "all keys and commands; any key goes back"},
	{12, "ctrl-L", RB_KEY_REDRAWS, "", "draw the screen anew"},
	{'q', "q", RB_KEY_RUNS, "quit", "leave the console"},
};
const int rb_key_row_count = sizeof rb_key_rows / sizeof *rb_key_rows;

const struct rb_key_row *rb_key_find(uint32_t key)
{
	for (int i = 0; i < rb_key_row_count; i++)
		if (rb_key_rows[i].key == key)
			return &rb_key_rows[i];
	return NULL;
}

void rb_keys_print_manual(FILE *file)
{
	fputs(".\\\" table keys\n.Bl -tag -width shift-right -compact\n", file);
	for (int i = 0; i < rb_key_row_count; i++) {
		const struct rb_key_row *const row = &rb_key_rows[i];
		/*
		 * a full stop, a comma or a bracket would be taken for punctuation of the sentence
		 */
		fprintf(file, ".It Li \\&%s\n", row->name);
		/*
		 * the help begins in lower case, as in lists; the manual has sentences. toupper
		 * would depend on the locale
		 */
		fputc(row->help[0] >= 'a' && row->help[0] <= 'z' ? row->help[0] - 'a' + 'A'
		                                                 : row->help[0],
		      file);
		fprintf(file, "%s.\n", row->help + 1);
	}
	fputs(".El\n.\\\" end\n", file);
}
