/* SPDX-License-Identifier: MIT */
/*
 * Keys stand for lines of the command language wherever that can say what they do, so that the
 * console, the socket and files of commands cannot drift apart. Only what needs the state of the
 * screen has an action of its own. The order is that of the help.
 */
#include "control/keys.h"

#include <stddef.h>

const struct rb_key_row rb_key_rows[] = {
	{' ', "space", RB_KEY_RUNS, "toggle", "play or pause"},
	{RB_KEY_LEFT, "left", RB_KEY_SEEKS, "-1", "back by 1 % of the run"},
	{RB_KEY_RIGHT, "right", RB_KEY_SEEKS, "1", "forward by 1 % of the run"},
	{RB_KEY_SHIFT_LEFT, "shift-left", RB_KEY_SEEKS, "-10", "back by 10 % of the run"},
	{RB_KEY_SHIFT_RIGHT, "shift-right", RB_KEY_SEEKS, "10", "forward by 10 % of the run"},
	{RB_KEY_HOME, "Home", RB_KEY_RUNS, "seek 0", "the first frame"},
	{RB_KEY_END, "End", RB_KEY_ENDS, "",
         "the last frame; while a run continues, follow its newest frame"},
	{'.', ".", RB_KEY_RUNS, "step", "one frame forward"},
	{',', ",", RB_KEY_RUNS, "back", "one frame back"},
	{'n', "n", RB_KEY_RUNS, "next collision", "the next frame with a collision"},
	{'p', "p", RB_KEY_RUNS, "previous collision", "the previous frame with a collision"},
	{'N', "N", RB_KEY_RUNS, "previous collision", "the same as p"},
	{'[', "[", RB_KEY_SCALES, "0.5", "half speed"},
	{']', "]", RB_KEY_SCALES, "2", "double speed"},
	{'1', "1", RB_KEY_RUNS, "speed 1", "real time"},
	{'g', "g", RB_KEY_TYPES, "seek ", "go to a time or a percentage"},
	{'c', "c", RB_KEY_TOGGLES_STOP, "", "pause at collisions: on or off"},
	{'V', "V", RB_KEY_TOGGLES_VIEW, "", "pause or play only your own view"},
	{'R', "R", RB_KEY_RUNS, "restart", "restart the simulation"},
	{'/', "/", RB_KEY_SEARCHES, "", "find a body by part of its name"},
	{'b', "b", RB_KEY_TYPES, "body ", "select a body by name"},
	{'f', "f", RB_KEY_FOLLOWS, "", "follow the selected body: on or off"},
	{'v', "v", RB_KEY_CAMERA, "", "the next camera of the scene"},
	{'a', "a", RB_KEY_RUNS, "camera all", "show everything that moves during the run"},
	{'+', "+", RB_KEY_RUNS, "camera zoom 1.25", "zoom in"},
	{'-', "-", RB_KEY_RUNS, "camera zoom 0.8", "zoom out"},
	{'h', "h", RB_KEY_RUNS, "camera orbit -10 0",
         "turn the camera around its target, to the left"},
	{'l', "l", RB_KEY_RUNS, "camera orbit 10 0", "the same, to the right"},
	{'k', "k", RB_KEY_RUNS, "camera orbit 0 10", "the same, upwards"},
	{'j', "j", RB_KEY_RUNS, "camera orbit 0 -10", "the same, downwards"},
	{'s', "s", RB_KEY_RUNS, "snapshot", "save a picture of this frame"},
	{':', ":", RB_KEY_TYPES, "",
         "type a command; Tab completes it, up and down recall earlier ones"},
	{'?', "?", RB_KEY_HELPS, "", "show all keys and commands; any key returns"},
	{12, "ctrl-L", RB_KEY_REDRAWS, "", "redraw the screen"},
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
