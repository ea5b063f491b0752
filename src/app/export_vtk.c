/* SPDX-License-Identifier: MIT */
/*
 * Surfaces for VTK's XML readers, in world coordinates: NAME.pvd lists times, NAME-vtk/K.vtp has
 * the triangles of frame K, with the id of the body of each, and colours and normals of corners.
 * Values stand behind the XML as they are in memory of a little-endian machine (appended, raw).
 * Contacts and springs, which are few, are text in NAME-vtk/K-contacts.vtp, a vertex each, and
 * K-springs.vtp, a line each.
 */
#include "app/exported.h"

#include <inttypes.h>
#include <stddef.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/joint_view.h"
#include "force/spring.h"
#include "math/quat.h"
#include "math/vec3.h"

/* All surfaces in object coordinates, one after the other. */
struct surfaces {
	struct rb_trimesh all;
	size_t *corner_first, *index_first; /* owned: [bodies + 1] */
	int count;                          /* bodies, by index */
	float *cells;                       /* owned: room for three numbers a corner */
};

static void release(struct surfaces *surfaces)
{
	rb_trimesh_release(&surfaces->all);
	rb_memory_free(surfaces->corner_first);
	rb_memory_free(surfaces->index_first);
	rb_memory_free(surfaces->cells);
}

static enum rb_status make_surfaces(struct surfaces *surfaces, const struct rb_exported *exported,
                                    struct rb_error *err)
{
	const struct rb_model *const model = exported->loaded.model;
	const struct rb_scene *const scene = &exported->loaded.scene;
	enum rb_status status = RB_OK;

	surfaces->count = model->body_count + model->static_count;
	const size_t room = (size_t)surfaces->count + 1;
	surfaces->corner_first = rb_memory_take(room, sizeof *surfaces->corner_first);
	surfaces->index_first = rb_memory_take(room, sizeof *surfaces->index_first);
	if (!surfaces->corner_first || !surfaces->index_first)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot make surfaces: out of memory");
	for (int i = 0; i < surfaces->count && !status; i++) {
		const struct rb_body_def *const body = &scene->bodies[model->id_of[i]];
		const struct rb_trimesh_patch patch = rb_exported_patch(exported, i);

		if (body->visible)
			status = rb_trimesh_add(&surfaces->all, scene, body, &patch, err);
		surfaces->corner_first[i + 1] = surfaces->all.corner_count;
		surfaces->index_first[i + 1] = surfaces->all.index_count;
	}
	surfaces->cells = rb_memory_take(3 * surfaces->all.corner_count + 1,
	                                 sizeof *surfaces->cells);
	if (!status && !surfaces->cells)
		status = RB_FAIL(err, RB_ERR_MEMORY, "cannot make surfaces: out of memory");
	return status;
}

/* Writes the length of a block, then the block. */
static void put_block(FILE *file, const void *bytes, uint64_t size)
{
	fwrite(&size, sizeof size, 1, file);
	fwrite(bytes, 1, size, file);
}

/* Positions or normals of all corners, turned and moved with their bodies. */
static void place(const struct surfaces *surfaces, const struct rb_exported *exported,
                  const struct rb_frame *frame, bool normals)
{
	for (int i = 0; i < surfaces->count; i++) {
		const rb_vec3 at = rb_exported_position(exported, frame, i);
		const rb_quat turn = rb_exported_orientation(exported, frame, i);

		for (size_t k = surfaces->corner_first[i]; k < surfaces->corner_first[i + 1]; k++) {
			const struct rb_trimesh_corner *const corner = &surfaces->all.corners[k];
			const float *const from = normals ? corner->normal : corner->position;
			rb_vec3 v = rb_quat_rotate(
				turn,
				rb_vec3_of((double)from[0], (double)from[1], (double)from[2]));
			if (!normals)
				v = rb_vec3_add(at, v);
			float *const to = surfaces->cells + 3 * k;
			to[0] = (float)v.x;
			to[1] = (float)v.y;
			to[2] = (float)v.z;
		}
	}
}

/* Triangles as VTK lists them: corners, ends, and the body of each; made and written one by one. */
static void put_triangles(const struct surfaces *surfaces, const struct rb_model *model, FILE *file)
{
	const uint64_t triangles = surfaces->all.index_count / 3;
	uint64_t size = surfaces->all.index_count * sizeof(int64_t);

	fwrite(&size, sizeof size, 1, file);
	for (size_t k = 0; k < surfaces->all.index_count; k++) {
		const int64_t corner = surfaces->all.indices[k];
		fwrite(&corner, sizeof corner, 1, file);
	}
	size = triangles * sizeof(int64_t);
	fwrite(&size, sizeof size, 1, file);
	for (uint64_t k = 0; k < triangles; k++) {
		const int64_t end = (int64_t)(3 * (k + 1));
		fwrite(&end, sizeof end, 1, file);
	}
	size = triangles * sizeof(int32_t);
	fwrite(&size, sizeof size, 1, file);
	for (int i = 0; i < surfaces->count; i++)
		for (size_t k = surfaces->index_first[i]; k < surfaces->index_first[i + 1];
		     k += 3) {
			const int32_t id = model->id_of[i];
			fwrite(&id, sizeof id, 1, file);
		}
}

/* The XML of one frame; offsets count from the underscore on. */
static void put_xml(const struct surfaces *surfaces, FILE *file)
{
	const uint64_t corners = surfaces->all.corner_count;
	const uint64_t triangles = surfaces->all.index_count / 3;
	const uint64_t vectors = corners * 12 + 8;
	const uint64_t at[] = {0,
	                       vectors,
	                       2 * vectors,
	                       3 * vectors,
	                       3 * vectors + 24 * triangles + 8,
	                       3 * vectors + 32 * triangles + 16};

	fprintf(file,
	        "<?xml version=\"1.0\"?>\n"
	        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
	        "header_type=\"UInt64\">\n<PolyData>\n"
	        "<Piece NumberOfPoints=\"%" PRIu64 "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
	        "NumberOfStrips=\"0\" NumberOfPolys=\"%" PRIu64 "\">\n",
	        corners, triangles);
	fprintf(file,
	        "<Points><DataArray type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\" "
	        "format=\"appended\" offset=\"%" PRIu64 "\"/></Points>\n",
	        at[0]);
	fprintf(file,
	        "<PointData Normals=\"normal\"><DataArray type=\"Float32\" Name=\"normal\" "
	        "NumberOfComponents=\"3\" format=\"appended\" offset=\"%" PRIu64 "\"/>\n"
	        "<DataArray type=\"Float32\" Name=\"colour\" NumberOfComponents=\"3\" "
	        "format=\"appended\" offset=\"%" PRIu64 "\"/></PointData>\n",
	        at[1], at[2]);
	fprintf(file,
	        "<Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"appended\" "
	        "offset=\"%" PRIu64 "\"/>\n<DataArray type=\"Int64\" Name=\"offsets\" "
	        "format=\"appended\" offset=\"%" PRIu64 "\"/></Polys>\n",
	        at[3], at[4]);
	fprintf(file,
	        "<CellData Scalars=\"id\"><DataArray type=\"Int32\" Name=\"id\" "
	        "format=\"appended\" offset=\"%" PRIu64 "\"/></CellData>\n"
	        "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_",
	        at[5]);
}

static void put_frame(const struct surfaces *surfaces, const struct rb_exported *exported,
                      const struct rb_frame *frame, FILE *file)
{
	const uint64_t size = surfaces->all.corner_count * 3 * sizeof(float);

	put_xml(surfaces, file);
	place(surfaces, exported, frame, false);
	put_block(file, surfaces->cells, size);
	place(surfaces, exported, frame, true);
	put_block(file, surfaces->cells, size);
	for (size_t k = 0; k < surfaces->all.corner_count; k++)
		memcpy(surfaces->cells + 3 * k, surfaces->all.corners[k].colour, 3 * sizeof(float));
	put_block(file, surfaces->cells, size);
	put_triangles(surfaces, exported->loaded.model, file);
	fputs("\n</AppendedData>\n</VTKFile>\n", file);
}

/* Begins an array of numbers in text; its end is fputs(array_end). */
static void begin_array(FILE *file, const char *type, const char *name, int width)
{
	fprintf(file,
	        "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" "
	        "format=\"ascii\">\n",
	        type, name, width);
}
static const char array_end[] = "</DataArray>\n";

/* A column of all contacts, `width` doubles at `offset` of each. */
static void put_column(const struct rb_frame *frame, const char *name, size_t offset, int width,
                       FILE *file)
{
	double values[3];

	begin_array(file, "Float64", name, width);
	for (int i = 0; i < frame->contact_count; i++) {
		memcpy(values, (const char *)&frame->contacts[i] + offset,
		       (size_t)width * sizeof *values);
		for (int k = 0; k < width; k++) {
			rb_exported_number(file, values[k]);
			putc(k + 1 < width ? ' ' : '\n', file);
		}
	}
	fputs(array_end, file);
}

/* A column of ids at `offset`; with `first` >= 0 the numbers from there on. */
static void put_integers(const struct rb_frame *frame, const char *name, size_t offset, int first,
                         FILE *file)
{
	begin_array(file, "Int32", name, 1);
	for (int i = 0; i < frame->contact_count; i++) {
		int value = i + first;
		if (first < 0)
			memcpy(&value, (const char *)&frame->contacts[i] + offset, sizeof value);
		fprintf(file, "%d\n", value);
	}
	fputs(array_end, file);
}

/* The contacts that last at a frame, with their forces. */
static void put_contacts(const struct rb_frame *frame, FILE *file)
{
	fprintf(file,
	        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\">\n<PolyData>\n"
	        "<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"%d\" NumberOfLines=\"0\" "
	        "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n",
	        frame->contact_count, frame->contact_count);
	put_column(frame, "Points", offsetof(struct rb_frame_contact, point), 3, file);
	fputs("</Points>\n<PointData Vectors=\"force\">\n", file);
	put_column(frame, "force", offsetof(struct rb_frame_contact, force), 3, file);
	put_column(frame, "normal", offsetof(struct rb_frame_contact, normal), 3, file);
	put_column(frame, "gap", offsetof(struct rb_frame_contact, gap), 1, file);
	put_integers(frame, "a", offsetof(struct rb_frame_contact, a), -1, file);
	put_integers(frame, "b", offsetof(struct rb_frame_contact, b), -1, file);
	fputs("</PointData>\n<Verts>\n", file);
	put_integers(frame, "connectivity", 0, 0, file);
	put_integers(frame, "offsets", 0, 1, file);
	fputs("</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n", file);
}

/* Springs from end to end, as far as they are seen, with their numbers. */
static void put_springs(const struct rb_model *model, const struct rb_frame *frame, FILE *file)
{
	const int count = rb_scene_element_count(model->scene, &rb_force_spring);
	rb_vec3 end[2];
	int seen = 0;

	for (int k = 0; k < count; k++)
		seen += rb_spring_ends(model, frame, k, end);
	fprintf(file,
	        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\">\n<PolyData>\n"
	        "<Piece NumberOfPoints=\"%d\" NumberOfVerts=\"0\" NumberOfLines=\"%d\" "
	        "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n",
	        2 * seen, seen);
	begin_array(file, "Float64", "Points", 3);
	for (int k = 0; k < count; k++)
		for (int e = 0; e < 2 && rb_spring_ends(model, frame, k, end); e++) {
			rb_exported_number(file, end[e].x);
			putc(' ', file);
			rb_exported_number(file, end[e].y);
			putc(' ', file);
			rb_exported_number(file, end[e].z);
			putc('\n', file);
		}
	fprintf(file, "%s</Points>\n<CellData>\n", array_end);
	begin_array(file, "Int32", "spring", 1);
	for (int k = 0; k < count; k++)
		if (rb_spring_ends(model, frame, k, end))
			fprintf(file, "%d\n", k);
	fprintf(file, "%s</CellData>\n<Lines>\n", array_end);
	begin_array(file, "Int32", "connectivity", 1);
	for (int k = 0; k < seen; k++)
		fprintf(file, "%d %d\n", 2 * k, 2 * k + 1);
	fputs(array_end, file);
	begin_array(file, "Int32", "offsets", 1);
	for (int k = 0; k < seen; k++)
		fprintf(file, "%d\n", 2 * (k + 1));
	fprintf(file, "%s</Lines>\n</Piece>\n</PolyData>\n</VTKFile>\n", array_end);
}

/* What a frame has a file of: names and endings. */
enum part { SURFACES, CONTACTS, SPRINGS, PART_COUNT };
static const char *const part_names[PART_COUNT][2] = {
	{"surfaces", ""}, {"contacts", "-contacts"}, {"springs", "-springs"}};

/* What stands before the ending, and the folder of the frames, both from where the .pvd is. */
struct names {
	char stem[RB_EXPORT_NAME_SIZE]; /* with its folder */
	const char *base;               /* without, in stem */
};

/* Writes one file of a frame. */
static enum rb_status write_part(struct rb_exported *exported, const struct surfaces *surfaces,
                                 const struct names *names, const struct rb_frame *frame,
                                 enum part part, struct rb_error *err)
{
	char name[RB_EXPORT_NAME_SIZE + 64];
	struct rb_outfile out;

	snprintf(name, sizeof name, "%s-vtk/%06" PRIu64 "%s.vtp", names->stem, frame->index,
	         part_names[part][1]);
	const enum rb_status status = rb_exported_begin(exported, &out, name, err);
	if (status)
		return status;
	if (part == SURFACES)
		put_frame(surfaces, exported, frame, out.file);
	else if (part == CONTACTS)
		put_contacts(frame, out.file);
	else
		put_springs(exported->loaded.model, frame, out.file);
	return rb_exported_publish(exported, &out, name, NULL, err);
}

/* An entry of the list of times. */
static void list_part(const struct names *names, const struct rb_frame *frame, enum part part,
                      FILE *list)
{
	fputs("<DataSet timestep=\"", list);
	rb_exported_number(list, frame->time_s);
	fprintf(list, "\" part=\"%d\" name=\"%s\" file=\"", (int)part, part_names[part][0]);
	for (const char *c = names->base; *c; c++) { /* as an attribute of XML */
		if (strchr("&<>\"", *c) || (unsigned char)*c < ' ')
			fprintf(list, "&#%d;", (unsigned char)*c);
		else
			putc(*c, list);
	}
	fprintf(list, "-vtk/%06" PRIu64 "%s.vtp\"/>\n", frame->index, part_names[part][1]);
}

/* Writes all frames, and their list. */
static enum rb_status write_all(struct rb_exported *exported, const struct surfaces *surfaces,
                                const struct names *names, FILE *list, struct rb_error *err)
{
	const bool has[PART_COUNT] = {
		true, (exported->reading->fields & RB_FIELD_CONTACTS) != 0,
		rb_scene_element_count(&exported->loaded.scene, &rb_force_spring) > 0};
	struct rb_frame frame;
	char first[RB_EXPORT_NAME_SIZE + 64];

	snprintf(first, sizeof first, "%s-vtk/000000.vtp", names->stem);
	enum rb_status status = rb_outfile_folders(first, exported->options->force, err);
	fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n"
	      "<Collection>\n",
	      list);
	for (uint64_t row = 0; row < exported->reading->frame_count && !status; row++) {
		status = exported->module->reader_frame(exported->reader, row, &frame, err);
		for (int part = 0; part < PART_COUNT && !status; part++)
			if (has[part]) {
				status = write_part(exported, surfaces, names, &frame,
				                    (enum part)part, err);
				list_part(names, &frame, (enum part)part, list);
			}
	}
	fputs("</Collection>\n</VTKFile>\n", list);
	return status;
}

static enum rb_status write_vtk(struct rb_exported *exported, const char *name,
                                struct rb_error *err)
{
	const size_t size = strlen(name);
	const bool ends = size > 4 && strcmp(name + size - 4, ".pvd") == 0;
	struct surfaces surfaces = {0};
	struct names names;
	struct rb_outfile out;

	if (size >= RB_EXPORT_NAME_SIZE - 40)
		return RB_FAIL(err, RB_ERR_CREATE, "the name '%s' is too long", name);
	if (!ends)
		return RB_FAIL(err, RB_ERR_USAGE, "option '--output': '%s' must end in .pvd", name);
	snprintf(names.stem, sizeof names.stem, "%.*s", (int)size - 4, name);
	const char *const slash = strrchr(names.stem, '/');
	names.base = slash ? slash + 1 : names.stem;
	enum rb_status status = make_surfaces(&surfaces, exported, err);
	if (!status)
		status = rb_exported_begin(exported, &out, name, err);
	if (status) {
		release(&surfaces);
		return status;
	}
	status = write_all(exported, &surfaces, &names, out.file, err);
	release(&surfaces);
	if (!status)
		return rb_exported_publish(
			exported, &out, name,
			&(struct rb_export_content){exported->reading->frame_count, "frame",
		                                    "frames"},
			err);
	rb_outfile_release(&out);
	return status;
}

const struct rb_export_form rb_export_vtk = {"vtk", ".pvd", write_vtk, true};
