/* SPDX-License-Identifier: MIT */
/*
 * Help, the manual's option list and the completions of shells are printed from the table of
 * options; an option that is added there is in all of them.
 */
#include "app/help.h"

#include <math.h>
#include <string.h>

#include "base/visible.h"

/*
 * Prints commands that can be copied, with what is said of them in a column behind; lines of
 * "COMMAND\tTEXT".
 */
static void print_examples(FILE *file, const char *examples)
{
	size_t longest = 0;

	for (const char *line = examples; *line; line += strcspn(line, "\n") + 1) {
		const size_t command = strcspn(line, "\t");

		longest = command > longest ? command : longest;
	}
	for (const char *line = examples; *line;) {
		const size_t command = strcspn(line, "\t");
		const size_t whole = strcspn(line, "\n");
		fprintf(file, "  %-*.*s  # %.*s\n", (int)longest, (int)command, line,
		        (int)(whole - command - 1), line + command + 1);
		line += whole + 1;
	}
}

/* Prints a row as --help shows it. */
static void print_option(FILE *file, const struct rb_option_row *row)
{
	char left[64];

	snprintf(left, sizeof left, "%c%c%c --%s%s%s", row->letter ? '-' : ' ',
	         row->letter ? row->letter : ' ', row->letter ? ',' : ' ', row->name,
	         row->argument ? " " : "", row->argument ? row->argument : "");
	fprintf(file, "  %-26s %s", left, row->help);
	if (row->choices)
		fprintf(file, ": %s", row->choices);
	putc('\n', file);
}

void rb_help_print_overview(FILE *file)
{
	fprintf(file,
	        "rbsim simulates rigid bodies: scenes in Lua, recordings in HDF5, films.\n\n");
	for (int i = 0; i < RB_VERB_COUNT; i++) {
		const struct rb_verb_row *const verb = &rb_verbs[i];

		fprintf(file, "  %-8s %s\n             %.*s\n", verb->name, verb->help,
		        (int)strcspn(verb->examples, "\t\n"), verb->examples);
	}
	fprintf(file, "\nSee 'rbsim help VERB' for one of them, rbsim(1) for all.\n");
}

void rb_help_print(FILE *file, const struct rb_options *options)
{
	const struct rb_verb_row *const verb = &rb_verbs[options->verb];

	if (options->verb_given)
		fprintf(file, "usage: rbsim %s%s%s [OPTION]...\n", verb->name,
		        *verb->operands ? " " : "", verb->operands);
	else
		fprintf(file, "usage: rbsim [run] SCENE.lua [OPTION]...\n       rbsim VERB "
		              "[OPERAND]... [OPTION]...\n");
	fprintf(file, "%c%s.\n\nExamples:\n", verb->help[0] - 'a' + 'A', verb->help + 1);
	print_examples(file, verb->examples);
	if (!options->verb_given) {
		fprintf(file, "\nVerbs:\n");
		for (int i = 0; i < RB_VERB_COUNT; i++)
			fprintf(file, "  %-8s %-17s %s\n", rb_verbs[i].name, rb_verbs[i].operands,
			        rb_verbs[i].help);
		fprintf(file, "  See 'rbsim VERB --help' for one of them.\n");
	}
	fprintf(file, "\nOptions%s:\n", options->verb_given ? "" : " of run");
	for (int i = 0; i < rb_option_row_count; i++)
		if (rb_option_rows[i].help && rb_option_rows[i].verbs & 1u << options->verb)
			print_option(file, &rb_option_rows[i]);
	fprintf(file, "\nSee rbsim(1), rbsim-scene(5) and rbsim-recording(5).\n");
}

/* Prints what values a parameter may have. */
static void print_range(FILE *file, const struct rb_param_def *param)
{
	if (param->choices)
		rb_print(file, "one of %s", param->choices);
	else if (!isnan(param->min) && !isnan(param->max))
		rb_print(file, "%g to %g", param->min, param->max);
	else if (!isnan(param->min))
		rb_print(file, "at least %g", param->min);
	else if (!isnan(param->max))
		rb_print(file, "at most %g", param->max);
}

void rb_help_print_params(FILE *file, const struct rb_scene *scene)
{
	if (scene->world.title && *scene->world.title)
		rb_print(file, "\nScene: %s\n", scene->world.title);
	if (scene->world.description && *scene->world.description)
		rb_print(file, "  %s\n", scene->world.description);
	if (scene->param_count == 0)
		rb_print(file, "\nParameters of %s: none\n", scene->file);
	else
		rb_print(file, "\nParameters of %s (--param NAME=VALUE):\n", scene->file);
	for (int i = 0; i < scene->param_count; i++) {
		const struct rb_param_def *param = &scene->params[i];
		char left[96];
		snprintf(left, sizeof left, "%s=%s", param->name, param->default_text);
		rb_print(file, "  %-26s %s", left, param->help ? param->help : "");
		if (param->choices || !isnan(param->min) || !isnan(param->max)) {
			rb_print(file, "%s(", param->help && *param->help ? " " : "");
			print_range(file, param);
			putc(')', file);
		}
		putc('\n', file);
	}
	bool named = false;
	for (int i = 0; i < scene->camera_count + scene->film_count; i++) {
		const char *const name =
			i < scene->camera_count ? scene->cameras[i].name
						: scene->films[i - scene->camera_count].camera.name;
		if (name && !named)
			rb_print(file, "\nCameras and films of %s (--camera NAME):\n", scene->file);
		if (name)
			rb_print(file, "  %s\n", name);
		named |= name != NULL;
	}
}

/* Prints "run, check": the verbs that take an option. */
static void print_verbs(FILE *file, unsigned verbs)
{
	const char *comma = "";

	for (int verb = 0; verb < RB_VERB_COUNT; verb++)
		if (verbs & 1u << verb) {
			fprintf(file, "%s%s", comma, rb_verbs[verb].name);
			comma = ", ";
		}
}

/* Prints a row as an mdoc item. */
static void print_option_item(FILE *file, const struct rb_option_row *row)
{
	fputs(".It ", file);
	if (row->letter)
		fprintf(file, "Fl %c , ", row->letter);
	fprintf(file, "Fl -%s", row->name);
	if (row->argument)
		fprintf(file, " Ar %s", row->argument);
	fprintf(file, "\n%c%s", row->help[0] - 'a' + 'A', row->help + 1);
	if (row->choices)
		fprintf(file, ": %s", row->choices);
	fputs(".\n", file);
	if (row->verbs != (1u << RB_VERB_COUNT) - 1) {
		putc('(', file);
		print_verbs(file, row->verbs);
		fputs(")\n", file);
	}
}

void rb_help_print_options(FILE *file)
{
	fputs(".\\\" table options\n.Bl -tag -width Ds\n", file);
	for (int i = 0; i < rb_option_row_count; i++)
		if (rb_option_rows[i].help)
			print_option_item(file, &rb_option_rows[i]);
	fputs(".El\n.\\\" end\n", file);
}

/* Whether a row above has the same name, for other verbs. */
static bool named_before(const struct rb_option_row *row)
{
	for (const struct rb_option_row *before = rb_option_rows; before < row; before++)
		if (strcmp(before->name, row->name) == 0)
			return true;
	return false;
}

static void print_verb_names(FILE *file)
{
	for (int verb = 0; verb < RB_VERB_COUNT; verb++)
		fprintf(file, "%s%s", verb > 0 ? " " : "", rb_verbs[verb].name);
}

/* Prints "auto classic" for "auto, classic". */
static void print_words(FILE *file, const char *choices)
{
	for (; *choices; choices++)
		if (*choices != ',')
			putc(*choices, file);
}

/* Under which heading of a scene's help the values of an option stand; NULL: under none. */
static const char *of_scene(const struct rb_option_row *row)
{
	return strcmp(row->name, "param") == 0    ? "Parameters"
	       : strcmp(row->name, "camera") == 0 ? "Cameras"
	                                          : NULL;
}

/* Prints a completion function for bash. */
static void print_bash(FILE *file)
{
	fputs("# SPDX-License-Identifier: MIT\n"
	      "# Completion of rbsim for bash; made by `rbsim --print-tables bash`.\n"
	      "# _rbsim_names Parameters|Cameras: those of the scene on the line\n"
	      "_rbsim_names()\n{\n"
	      "\tlocal w\n"
	      "\tfor w in \"${COMP_WORDS[@]:1}\"; do\n"
	      "\t\t[[ $w == *.lua && -f $w ]] && \"${COMP_WORDS[0]}\" \"$w\" --help "
	      "2>/dev/null </dev/null |\n"
	      "\t\t\tsed -n \"/^$1[a-z ]* of /,/^\\$/s/^  \\([A-Za-z_][A-Za-z0-9_]*\\).*/\\1/p\"\n"
	      "\tdone\n}\n"
	      "_rbsim()\n{\n"
	      "\tlocal word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb=run "
	      "w\n"
	      "\t[ \"$before\" = = ] && before=${COMP_WORDS[COMP_CWORD-2]}\n"
	      "\t[ \"$word\" = = ] && word=\n"
	      "\tfor w in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
	      "\t\tcase $w in ",
	      file);
	for (int verb = 0; verb < RB_VERB_COUNT; verb++)
		fprintf(file, "%s%s", verb > 0 ? "|" : "", rb_verbs[verb].name);
	fputs(") verb=$w ;; esac\n\tdone\n\tcase $before in\n", file);
	for (int i = 0; i < rb_option_row_count; i++) {
		const struct rb_option_row *const row = &rb_option_rows[i];
		if (!row->argument || !row->help || named_before(row))
			continue;
		fputs("\t", file);
		if (row->letter)
			fprintf(file, "-%c|", row->letter);
		fprintf(file, "--%s) ", row->name);
		if (row->choices) {
			fputs("COMPREPLY=($(compgen -W '", file);
			print_words(file, row->choices);
			fputs("' -- \"$word\")); return ;;\n", file);
		} else if (of_scene(row)) {
			fprintf(file,
			        "%sCOMPREPLY=($(compgen -W \"$(_rbsim_names %s)\"%s -- "
			        "\"$word\")); return ;;\n",
			        *of_scene(row) == 'P' ? "compopt -o nospace; " : "", of_scene(row),
			        *of_scene(row) == 'P' ? " -S =" : "");
		} else if (strcmp(row->argument, "FILE") == 0) {
			fputs("compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\")); "
			      "return ;;\n",
			      file);
		} else {
			fputs("return ;;\n", file);
		}
	}
	fputs("\tesac\n\tif [[ $word == -* ]]; then\n\t\tcase $verb in\n", file);
	for (int verb = 0; verb < RB_VERB_COUNT; verb++) {
		fprintf(file, "\t\t%s) COMPREPLY=($(compgen -W '", rb_verbs[verb].name);
		const char *space = "";
		for (int i = 0; i < rb_option_row_count; i++)
			if (rb_option_rows[i].help && rb_option_rows[i].verbs & 1u << verb) {
				fprintf(file, "%s--%s", space, rb_option_rows[i].name);
				space = " ";
			}
		fputs("' -- \"$word\")) ;;\n", file);
	}
	fputs("\t\tesac\n\t\treturn\n\tfi\n\tcompopt -o filenames\n\tCOMPREPLY=($(compgen -f -- "
	      "\"$word\"))\n"
	      "\t[ \"$COMP_CWORD\" -eq 1 ] && COMPREPLY+=($(compgen -W '",
	      file);
	print_verb_names(file);
	fputs("' -- \"$word\"))\n}\ncomplete -F _rbsim rbsim\n", file);
}

/* Prints a text for _arguments: brackets and colons have a meaning there, and a quote ends it. */
static void print_zsh_text(FILE *file, const char *text)
{
	for (; *text; text++) {
		if (*text == '\'')
			fputs("'\\''", file);
		else if (strchr("[]:", *text))
			fprintf(file, "\\%c", *text);
		else
			putc(*text, file);
	}
}

/* Prints a completion function for zsh. */
static void print_zsh(FILE *file)
{
	fputs("#compdef rbsim\n# SPDX-License-Identifier: MIT\n"
	      "# Completion of rbsim for zsh; made by `rbsim --print-tables zsh`.\n"
	      "# _rbsim_names Parameters|Cameras: those of the scene on the line\n"
	      "_rbsim_names()\n{\n"
	      "\tlocal w\n"
	      "\tfor w in $words; do\n"
	      "\t\t[[ $w == *.lua && -f $w ]] && compadd -S \"${${1:#Cameras}:+=}\" -- ${(f)\"$("
	      "$words[1] $w --help 2>/dev/null </dev/null |\n"
	      "\t\t\tsed -n \"/^$1[a-z ]* of /,/^\\$/s/^  "
	      "\\([A-Za-z_][A-Za-z0-9_]*\\).*/\\1/p\")\"}\n"
	      "\tdone\n}\n"
	      "_arguments -S \\\n",
	      file);
	for (int i = 0; i < rb_option_row_count; i++) {
		const struct rb_option_row *const row = &rb_option_rows[i];
		if (!row->help || named_before(row))
			continue;
		if (row->letter)
			fprintf(file, "\t%s{-%c%s,--%s%s}'[",
			        row->type == RB_OPTION_LIST ? "'*'" : "", row->letter,
			        row->argument ? "+" : "", row->name, row->argument ? "=" : "");
		else
			fprintf(file, "\t'%s--%s%s[", row->type == RB_OPTION_WORDS ? "*" : "",
			        row->name, row->argument ? "=" : "");
		print_zsh_text(file, row->help);
		putc(']', file);
		if (row->argument) {
			fprintf(file, ":%s:", row->argument);
			if (row->choices) {
				putc('(', file);
				print_words(file, row->choices);
				putc(')', file);
			} else if (of_scene(row)) {
				fprintf(file, "{ _rbsim_names %s }", of_scene(row));
			} else if (strcmp(row->argument, "FILE") == 0) {
				fputs("_files", file);
			}
		}
		fputs("' \\\n", file);
	}
	fputs("\t'1:verb or scene:{ compadd ", file);
	print_verb_names(file);
	fputs("; _files -g \"*.lua\" }' \\\n\t'*:file:_files'\n", file);
}

void rb_help_print_completion(FILE *file, const char *shell)
{
	if (strcmp(shell, "bash") == 0)
		print_bash(file);
	else
		print_zsh(file);
}
