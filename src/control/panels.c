/* SPDX-License-Identifier: MIT */
#include "control/panels.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "control/charts.h"
#include "control/keys.h"
#include "control/orders.h"

enum { LINE_SIZE = 512, CHART_MAX = 128, TIMELINE_MAX = 1024 };

/* ---- one line each ---- */

static void print_speed(char out[48], const struct rb_viewer *viewer)
{
	const double slower = 1 / viewer->speed;

	if (viewer->live)
		snprintf(out, 48, "newest frames");
	else if (slower > 1 && fabs(slower - nearbyint(slower)) < 1e-9 * slower && slower < 1e6)
		snprintf(out, 48, "speed 1/%.0f", slower);
	else
		snprintf(out, 48, "speed %.4g", viewer->speed);
}

void rb_panel_transport(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	const struct rb_source_status *const status = rb_source_status(viewer->options.source);
	const char *const late = viewer->starved ? "  the simulation cannot keep up" : "";
	const char *const stops = viewer->stops || status->stops_at_collision
	                                  ? "  stops at collisions"
	                                  : "";
	char first[LINE_SIZE], second[LINE_SIZE], speed[48];
	const uint64_t last = status->frame_count > 0 ? status->frame_count - 1 : 0;

	print_speed(speed, viewer);
	snprintf(first, sizeof first, " %-9s t %.4f of %.6g s  %s", rb_viewer_state(viewer),
	         viewer->frame.time_s, status->duration_s, speed);
	snprintf(second, sizeof second, " frame %" PRIu64 " of %" PRIu64 "%s%s  %s: %s",
	         viewer->frame.index, last, late, stops, viewer->options.name, status->state);
	if (area.height == 1) {
		snprintf(first + strlen(first), sizeof first - strlen(first), " %.200s", second);
		rb_screen_text(screen, area, 0, viewer->starved ? RB_STYLE_WARNING : RB_STYLE_BAR,
		               first);
		return;
	}
	rb_screen_text(screen, area, 0, RB_STYLE_BAR, first);
	rb_screen_text(screen, area, 1, viewer->starved ? RB_STYLE_WARNING : RB_STYLE_PLAIN,
	               second);
}

void rb_panel_timeline(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	const struct rb_source_status *const status = rb_source_status(viewer->options.source);
	const double whole = status->duration_s > 0 ? status->duration_s : 1;
	const struct rb_timeline line = {
		.position = viewer->frame.time_s / whole,
		.available = status->end_s / whole,
		.marks = rb_source_bins(viewer->options.source)->collisions,
		.mark_count = RB_SOURCE_BINS,
	};
	uint32_t glyphs[TIMELINE_MAX];
	const int width = area.width < TIMELINE_MAX ? area.width : TIMELINE_MAX;

	rb_chart_timeline(glyphs, width, &line, rb_screen_blocks(screen));
	for (int i = 0; i < width; i++)
		rb_screen_glyph(screen, area.x + i, area.y, glyphs[i], RB_STYLE_PLAIN);
}

/* ---- beside the picture ---- */

static const char *print_bytes(uint64_t bytes, char out[32])
{
	static const char *const units[] = {"bytes", "kB", "MB", "GB", "TB"};
	double value = (double)bytes;
	int unit = 0;

	while (value >= 999.5 && unit < 4) {
		value /= 1000;
		unit++;
	}
	snprintf(out, 32, "%.3g %s", value, units[unit]);
	return out;
}

void rb_panel_numbers(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	const struct rb_source_status *const s = rb_source_status(viewer->options.source);
	char line[9][64], size[32];
	int rows = 0;

	snprintf(line[rows++], 64, "%s", s->is_run ? "run" : "recording");
	snprintf(line[rows], 64, "real time  -");
	if (isfinite(s->real_time_factor))
		snprintf(line[rows], 64, "real time  %.4g x", s->real_time_factor);
	rows++;
	snprintf(line[rows++], 64, "collisions %" PRIu64, s->collisions);
	snprintf(line[rows++], 64, "contacts   %" PRIu64, viewer->frame.numbers.contacts);
	snprintf(line[rows++], 64, "rollbacks  %" PRIu64, s->rollbacks);
	snprintf(line[rows++], 64, "least step %.3g s", s->smallest_step_s);
	snprintf(line[rows], 64, "ring       -");
	if (s->ring_slots > 0)
		snprintf(line[rows], 64, "ring       %d of %d", s->ring_used, s->ring_slots);
	rows++;
	snprintf(line[rows++], 64, "disk       %s", print_bytes(s->bytes, size));
	for (int i = 0; i < area.height; i++)
		rb_screen_text(screen, area, i, i == 0 ? RB_STYLE_STRONG : RB_STYLE_PLAIN,
		               i < rows ? line[i] : "");
}

/* The bins of a chart's columns: the last one that is known of those that fall together, or the largest. */
static void gather(double *out, int width, const double *bins, const double *more, bool largest)
{
	for (int x = 0; x < width; x++) {
		double value = (double)NAN;
		const int from = x * RB_SOURCE_BINS / width;
		const int to = (x + 1) * RB_SOURCE_BINS / width;
		for (int i = from; i < to || i == from; i++) {
			const double bin = bins[i] + (more ? more[i] : 0);
			if (isfinite(bin))
				value = largest ? fmax(value, bin) : bin;
		}
		/* a run of few frames has bins between them */
		out[x] = isfinite(value) || x == 0 || largest ? value : out[x - 1];
	}
}

static void chart(struct rb_screen *screen, rb_area area, int row, const char *name,
                  const double *values)
{
	enum { NAME = 10, NUMBER = 9 };
	const int width = area.width - NAME - NUMBER;
	uint32_t glyphs[CHART_MAX];
	double low, high;
	char text[64];

	if (row >= area.height || width < 4)
		return;
	rb_chart_range(values, width, &low, &high);
	rb_chart_spark(glyphs, values, width, fmin(low, 0), high, rb_screen_blocks(screen));
	rb_screen_text(screen, (rb_area){area.x, area.y + row, NAME, 1}, 0, RB_STYLE_PLAIN, name);
	for (int i = 0; i < width; i++)
		rb_screen_glyph(screen, area.x + NAME + i, area.y + row, glyphs[i], RB_STYLE_PLAIN);
	snprintf(text, sizeof text, " %.3g", high);
	rb_screen_text(screen, (rb_area){area.x + NAME + width, area.y + row, NUMBER, 1}, 0,
	               RB_STYLE_FAINT, text);
}

void rb_panel_charts(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	const struct rb_source_bins *const bins = rb_source_bins(viewer->options.source);
	const int width = area.width - 19 < CHART_MAX ? area.width - 19 : CHART_MAX;
	double values[CHART_MAX];

	if (width < 4)
		return;
	rb_screen_text(screen, area, 0, RB_STYLE_STRONG, "energy (J), overlap (m)");
	gather(values, width, bins->kinetic, NULL, false);
	chart(screen, area, 1, "kinetic", values);
	gather(values, width, bins->kinetic, bins->potential, false);
	chart(screen, area, 2, "total", values);
	gather(values, width, bins->penetration, NULL, true);
	chart(screen, area, 3, "overlap", values);
	rb_screen_text(screen, area, 4, RB_STYLE_PLAIN, "");
}

void rb_panel_body(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	char line[96];
	int row = 0;

	if (viewer->inspected < 0)
		rb_screen_text(screen, area, row++, RB_STYLE_FAINT, "/ looks for a body");
	for (; viewer->inspected >= 0 && row < area.height &&
	       rb_order_body_line(viewer, viewer->inspected, row, line);
	     row++)
		rb_screen_text(screen, area, row, row == 0 ? RB_STYLE_STRONG : RB_STYLE_PLAIN,
		               line);
	for (; row < area.height; row++)
		rb_screen_text(screen, area, row, RB_STYLE_PLAIN, "");
}

/* ---- log and help ---- */

void rb_panel_log(struct rb_screen *screen, rb_area area, const struct rb_viewer *viewer)
{
	for (int row = 0; row < area.height; row++) {
		const uint64_t back = (uint64_t)(area.height - row);
		const bool there = back <= viewer->log_count && back <= RB_VIEWER_LOG_LINES;
		rb_screen_text(
			screen, area, row, row == area.height - 1 ? RB_STYLE_PLAIN : RB_STYLE_FAINT,
			there ? viewer->log[(viewer->log_count - back) % RB_VIEWER_LOG_LINES] : "");
	}
}

static void help_line(int line, char out[LINE_SIZE])
{
	const int commands = rb_key_row_count + 3;
	char usage[128];

	out[0] = '\0';
	if (line == 0) {
		snprintf(out, LINE_SIZE, "Keys (up, down: more; any other key: back)");
	} else if (line <= rb_key_row_count) {
		const struct rb_key_row *const row = &rb_key_rows[line - 1];
		snprintf(out, LINE_SIZE, "  %-11s %s", row->name, row->help);
	} else if (line == commands - 1) {
		snprintf(out, LINE_SIZE, "Commands, behind :");
	} else if (line >= commands) {
		const struct rb_command_row *const row = &rb_commands[line - commands];
		snprintf(usage, sizeof usage, "%s %s", row->name, row->arguments);
		snprintf(out, LINE_SIZE, "  %-28s %s", usage, row->help);
	}
}

void rb_panel_help(struct rb_screen *screen, rb_area area, int *first)
{
	const int count = rb_key_row_count + 3 + RB_COMMAND_KIND_COUNT;
	const int last = count > area.height ? count - area.height : 0;
	char line[LINE_SIZE];

	*first = *first < 0 ? 0 : *first > last ? last : *first;
	for (int row = 0; row < area.height; row++) {
		line[0] = '\0';
		if (*first + row < count)
			help_line(*first + row, line);
		rb_screen_text(screen, area, row,
		               *line && *line != ' ' ? RB_STYLE_STRONG : RB_STYLE_PLAIN, line);
	}
}
