/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/exports.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/base/c_locale.h"
#include "engine/base/number_text.h"
#include "engine/forces/elements.h"
#include "engine/model/model.h"
#include "engine/output/buffer.h"
#include "engine/output/file.h"
#include "engine/output/results.h"
#include "engine/output/trajectory.h"
#include "engine/scene/profile.h"

/* Data shared by all frames of a motion, and their buffers. */
typedef struct vtk_frame {
  const strut_model *model;
  const strut_trajectory *motion;
  double *points; /* (nodes, 3) */
  double *cells;  /* (members) */
  int32_t *whole; /* (max(members, points of their lines, nodes)) */
  strut_arena arena;
} vtk_frame;

/* ---- the texts of frames and of the ground ---- */

static const char head[] =
    "<?xml version=\"1.0\"?>\n"
    "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
    "header_type=\"UInt64\">\n<PolyData>\n";
static const char tail[] = "</Piece>\n</PolyData>\n</VTKFile>\n";

static bool vtk_frame_create(vtk_frame *frame, const strut_model *model,
                             const strut_trajectory *motion) {
  size_t nodes = model->scene->node_count, members = model->scene->member_count;
  size_t whole = nodes, points = 0;
  for (size_t j = 0; j < members; j++) points += model->scene->members[j].guide_count + 2;
  if (points > whole) whole = points;
  *frame = (vtk_frame){.model = model, .motion = motion};
  frame->points = strut_arena_allocate(&frame->arena, 3 * nodes, sizeof(double));
  frame->cells = strut_arena_allocate(&frame->arena, members, sizeof(double));
  frame->whole = strut_arena_allocate(&frame->arena, whole, sizeof(int32_t));
  return frame->points && frame->cells && frame->whole;
}

static void vtk_frame_free(vtk_frame *frame) { strut_arena_free(&frame->arena); }

static void put_little(unsigned char *to, uint64_t bits, size_t size) {
  for (size_t i = 0; i < size; i++) to[i] = (unsigned char)(bits >> (8 * i));
}

/* An array's bytes behind their number, as VTK has them inline; items of 4 or 8 bytes. The groups
 * handed over are multiples of 3 bytes, or the base64 of the parts would not join. */
static void add_bytes(strut_buffer *buffer, const void *items, size_t count, size_t size) {
  unsigned char part[24 * 64];
  size_t held = 8;
  put_little(part, (uint64_t)(count * size), 8);
  for (size_t i = 0; i < count; i++) {
    uint64_t bits = 0;
    if (size == 8) {
      memcpy(&bits, (const char *)items + 8 * i, 8);
    } else {
      uint32_t half;
      memcpy(&half, (const char *)items + 4 * i, 4);
      bits = half;
    }
    put_little(part + held, bits, size);
    held += size;
    if (held < sizeof part) continue;
    strut_base64_add(buffer, part, held);
    held = 0;
  }
  strut_base64_add(buffer, part, held);
}

static void add_array(strut_buffer *buffer, const char *type, const char *name, int components,
                      const void *items, size_t count) {
  strut_buffer_add(buffer, "<DataArray type=\"%s\" Name=\"%s\"", type, name);
  if (components > 1) strut_buffer_add(buffer, " NumberOfComponents=\"%d\"", components);
  strut_buffer_add(buffer, " format=\"binary\">");
  add_bytes(buffer, items, count, strcmp(type, "Float64") == 0 ? 8 : 4);
  strut_buffer_add(buffer, "</DataArray>\n");
}

static void begin_names(strut_buffer *buffer, const char *name, size_t count) {
  strut_buffer_add(buffer,
                   "<DataArray type=\"String\" Name=\"%s\" NumberOfTuples=\"%zu\" "
                   "format=\"ascii\">",
                   name, count);
}

/* Writes one text of a string array: its bytes as numbers, ended by 0. */
static void add_name(strut_buffer *buffer, const char *text) {
  for (; *text; text++) strut_buffer_add(buffer, "%d ", (unsigned char)*text);
  strut_buffer_add(buffer, "0 ");
}

static void add_fields(const vtk_frame *frame, size_t i, strut_buffer *buffer) {
  const strut_scene *scene = frame->model->scene;
  double time = frame->motion->time ? frame->motion->time[i] : 0;
  strut_buffer_add(buffer,
                   "<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" "
                   "NumberOfTuples=\"1\" format=\"binary\">");
  add_bytes(buffer, &time, 1, 8);
  strut_buffer_add(buffer, "</DataArray>\n");
  begin_names(buffer, "node_names", scene->node_count);
  for (size_t k = 0; k < scene->node_count; k++) add_name(buffer, scene->nodes[k].name);
  strut_buffer_add(buffer, "</DataArray>\n");
  begin_names(buffer, "member_names", scene->member_count);
  for (size_t k = 0; k < scene->member_count; k++) add_name(buffer, scene->members[k].name);
  strut_buffer_add(buffer, "</DataArray>\n</FieldData>\n");
}

/* Writes plane vectors, relative to an origin or NULL, into points. */
static void spread(vtk_frame *frame, const double *plane, const double *origin) {
  size_t nodes = frame->model->scene->node_count;
  for (size_t k = 0; k < nodes; k++) {
    frame->points[3 * k] = plane[2 * k] - (origin ? origin[2 * k] : 0);
    frame->points[3 * k + 1] = plane[2 * k + 1] - (origin ? origin[2 * k + 1] : 0);
    frame->points[3 * k + 2] = 0;
  }
}

/* Of a node at `at` in frame i, to where its ground has moved by then. */
static strut_contact_axes surface_axes(const strut_model *model, int32_t index, const double *at,
                                       const strut_trajectory *motion, size_t i) {
  const strut_surface *surface = &model->contacts.surface[index];
  double place[2] = {0.0, 0.0};
  if (motion->time)
    strut_ground_place(model->scene, (size_t)surface->ground, motion->time[i], place);
  const double point[2] = {at[0] - place[0], at[1] - place[1]};
  strut_contact_pose pose;
  strut_surface_find(surface, point, -1, &pose);
  return pose.axes;
}

static void gather_contact(vtk_frame *frame, size_t i) {
  const strut_trajectory *motion = frame->motion;
  const strut_contact_table *table = &frame->model->contacts;
  const double *force = motion->contact + 2 * motion->contact_count * i;
  memset(frame->points, 0, 3 * frame->model->scene->node_count * sizeof *frame->points);
  for (size_t k = 0; k < motion->contact_count; k++) {
    double *to = frame->points + 3 * motion->contact_node[k];
    const double *at =
        motion->position + 2 * (i * motion->node_count + (size_t)motion->contact_node[k]);
    strut_contact_axes axes = table->axes;
    if (table->surface) axes = surface_axes(frame->model, table->surface_of[k], at, motion, i);
    for (int axis = 0; axis < 2; axis++)
      to[axis] += force[2 * k] * axes.normal[axis] + force[2 * k + 1] * axes.tangent[axis];
  }
}

static void add_point_data(vtk_frame *frame, size_t i, strut_buffer *buffer) {
  const strut_trajectory *motion = frame->motion;
  size_t nodes = frame->model->scene->node_count;
  strut_buffer_add(buffer, "<PointData>\n");
  for (size_t k = 0; k < nodes; k++) frame->whole[k] = (int32_t)k;
  add_array(buffer, "Int32", "node", 1, frame->whole, nodes);
  spread(frame, motion->position + 2 * nodes * i, motion->position);
  add_array(buffer, "Float64", "displacement", 3, frame->points, 3 * nodes);
  if (motion->velocity) {
    spread(frame, motion->velocity + 2 * nodes * i, NULL);
    add_array(buffer, "Float64", "velocity", 3, frame->points, 3 * nodes);
  }
  if (motion->contact && motion->contact_count > 0) {
    gather_contact(frame, i);
    add_array(buffer, "Float64", "contact_force", 3, frame->points, 3 * nodes);
  }
  strut_buffer_add(buffer, "</PointData>\n");
}

/* Lengths as recorded, or from the positions. */
static void gather_lengths(vtk_frame *frame, size_t i) {
  const strut_scene *scene = frame->model->scene;
  const strut_trajectory *motion = frame->motion;
  const double *q = motion->position + 2 * scene->node_count * i;
  for (size_t k = 0; k < scene->member_count; k++)
    frame->cells[k] = motion->length ? motion->length[scene->member_count * i + k]
                                     : strut_member_path_length(frame->model, (int32_t)k, q);
}

static void add_cell_data(vtk_frame *frame, size_t i, strut_buffer *buffer) {
  const strut_scene *scene = frame->model->scene;
  const double *rest = frame->model->members.rest;
  size_t members = scene->member_count;
  const double *force = frame->motion->force ? frame->motion->force + members * i : NULL;
  strut_buffer_add(buffer, "<CellData>\n");
  for (size_t k = 0; k < members; k++) frame->whole[k] = (int32_t)scene->members[k].kind;
  add_array(buffer, "Int32", "kind", 1, frame->whole, members);
  gather_lengths(frame, i);
  for (size_t k = 0; k < members; k++) {
    bool loose = force ? force[k] == 0 : frame->cells[k] <= rest[k];
    frame->whole[k] = scene->members[k].kind == STRUT_CABLE && loose;
  }
  add_array(buffer, "Int32", "slack", 1, frame->whole, members);
  add_array(buffer, "Float64", "length", 1, frame->cells, members);
  for (size_t k = 0; k < members; k++)
    frame->cells[k] = rest[k] > 0 ? frame->cells[k] / rest[k] - 1 : 0;
  add_array(buffer, "Float64", "strain", 1, frame->cells, members);
  if (force) add_array(buffer, "Float64", "force", 1, force, members);
  strut_buffer_add(buffer, "</CellData>\n");
}

/* The members as lines, a running cable over its guides. */
static void add_lines(vtk_frame *frame, strut_buffer *buffer) {
  const strut_scene *scene = frame->model->scene;
  size_t points = 0, end = 0;
  for (size_t j = 0; j < scene->member_count; j++)
    for (size_t k = 0; k < scene->members[j].guide_count + 2; k++)
      frame->whole[points++] = strut_member_node(&scene->members[j], k);
  strut_buffer_add(buffer, "<Lines>\n");
  add_array(buffer, "Int32", "connectivity", 1, frame->whole, points);
  for (size_t j = 0; j < scene->member_count; j++)
    frame->whole[j] = (int32_t)(end += scene->members[j].guide_count + 2);
  add_array(buffer, "Int32", "offsets", 1, frame->whole, scene->member_count);
  strut_buffer_add(buffer, "</Lines>\n");
}

/* Nodes without members, each a cell of its own. */
static void add_vertices(vtk_frame *frame, strut_buffer *buffer) {
  size_t nodes = frame->model->scene->node_count;
  for (size_t k = 0; k < nodes; k++) frame->whole[k] = (int32_t)k;
  strut_buffer_add(buffer, "<Verts>\n");
  add_array(buffer, "Int32", "connectivity", 1, frame->whole, nodes);
  for (size_t k = 0; k < nodes; k++) frame->whole[k] = (int32_t)k + 1;
  add_array(buffer, "Int32", "offsets", 1, frame->whole, nodes);
  strut_buffer_add(buffer, "</Verts>\n");
}

static void vtk_frame_write(vtk_frame *frame, size_t i, strut_buffer *buffer) {
  size_t nodes = frame->model->scene->node_count, members = frame->model->scene->member_count;
  strut_buffer_add(buffer, "%s", head);
  add_fields(frame, i, buffer);
  strut_buffer_add(buffer,
                   "<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\" NumberOfLines=\"%zu\" "
                   "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n",
                   nodes, members ? (size_t)0 : nodes, members);
  add_point_data(frame, i, buffer);
  if (members) add_cell_data(frame, i, buffer);
  spread(frame, frame->motion->position + 2 * nodes * i, NULL);
  strut_buffer_add(buffer, "<Points>\n");
  add_array(buffer, "Float64", "Points", 3, frame->points, 3 * nodes);
  strut_buffer_add(buffer, "</Points>\n");
  if (members) {
    add_lines(frame, buffer);
  } else {
    add_vertices(frame, buffer);
  }
  strut_buffer_add(buffer, "%s", tail);
}

static void vtk_ground_write(const strut_model *model, double low, double high,
                             strut_buffer *buffer) {
  const strut_ground *ground = &model->scene->ground;
  double steep = tan(ground->slope);
  const double points[] = {low,  ground->height + low * steep,  0,
                           high, ground->height + high * steep, 0};
  const int32_t ends[] = {0, 1}, offset = 2;
  strut_buffer_add(buffer,
                   "%s<Piece NumberOfPoints=\"2\" NumberOfVerts=\"0\" NumberOfLines=\"1\" "
                   "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n",
                   head);
  add_array(buffer, "Float64", "Points", 3, points, 6);
  strut_buffer_add(buffer, "</Points>\n<Lines>\n");
  add_array(buffer, "Int32", "connectivity", 1, ends, 2);
  add_array(buffer, "Int32", "offsets", 1, &offset, 1);
  strut_buffer_add(buffer, "</Lines>\n%s", tail);
}

/* The outlines of all grounds, as drawn, around `middle`. */
static bool vtk_surfaces_write(const strut_model *model, const double middle[2], double far,
                               strut_buffer *buffer) {
  const strut_scene *scene = model->scene;
  strut_arena arena = {0};
  size_t most = 0, used = 0;
  for (size_t g = 0; g < scene->ground_count; g++) most += strut_outline_most(&scene->grounds[g]);
  double(*plane)[2] = strut_arena_allocate(&arena, most, sizeof *plane);
  double *points = strut_arena_allocate(&arena, 3 * most, sizeof *points);
  int32_t *index = strut_arena_allocate(&arena, most, sizeof *index);
  int32_t *offset = strut_arena_allocate(&arena, scene->ground_count, sizeof *offset);
  bool good = plane && points && index && offset;
  for (size_t g = 0; g < scene->ground_count && good; g++) {
    used += strut_outline_of(&scene->grounds[g], NULL, middle, far, plane + used);
    offset[g] = (int32_t)used;
  }
  for (size_t k = 0; k < used; k++) {
    points[3 * k] = plane[k][0], points[3 * k + 1] = plane[k][1];
    index[k] = (int32_t)k;
  }
  if (good) {
    strut_buffer_add(buffer,
                     "%s<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"0\" NumberOfLines=\"%zu\" "
                     "NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n",
                     head, used, scene->ground_count);
    add_array(buffer, "Float64", "Points", 3, points, 3 * used);
    strut_buffer_add(buffer, "</Points>\n<Lines>\n");
    add_array(buffer, "Int32", "connectivity", 1, index, used);
    add_array(buffer, "Int32", "offsets", 1, offset, scene->ground_count);
    strut_buffer_add(buffer, "</Lines>\n%s", tail);
  }
  strut_arena_free(&arena);
  return good;
}

/* ---- files ---- */

enum { FRAME_NAME = 24, OTHERS = 2 };

static const char list_name[] = "structure.pvd", ground_name[] = "ground.vtp";

static const char *frame_name(size_t i, char name[FRAME_NAME]) {
  snprintf(name, FRAME_NAME, "structure_%05u.vtp", (unsigned)(i % 100000));
  return name;
}

/* The number of a frame's file, or -1. */
static int frame_number(const char *name) {
  unsigned number;
  char again[FRAME_NAME];
  if (sscanf(name, "structure_%5u.vtp", &number) != 1) return -1;
  return strcmp(name, frame_name(number, again)) == 0 ? (int)number : -1;
}

/* Number of frames that an earlier export left in the directory. */
static size_t frames_there(const char *path) {
  size_t count = 0;
  DIR *directory = opendir(path);
  if (!directory) return 0;
  for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
    int number = frame_number(entry->d_name);
    if (number >= 0 && (size_t)number >= count) count = (size_t)number + 1;
  }
  closedir(directory);
  return count;
}

/* Names of all files of this and an earlier export, in the arena, ending with NULL; or NULL. */
static const char **file_names(const char *directory, size_t frames, strut_arena *arena) {
  size_t there = frames_there(directory), count = frames > there ? frames : there;
  const char **names = strut_arena_allocate(arena, count + OTHERS + 1, sizeof *names);
  char(*texts)[FRAME_NAME] = strut_arena_allocate(arena, count, sizeof *texts);
  if (!names || !texts) return NULL;
  for (size_t i = 0; i < count; i++) names[i] = frame_name(i, texts[i]);
  names[count] = ground_name;
  names[count + 1] = list_name;
  return names;
}

/* Writes a text and empties the buffer. Frames are not synchronised individually, as there are many. */
static strut_status write_text(const char *directory, const char *name, strut_buffer *buffer,
                               strut_error *error) {
  strut_arena arena = {0};
  char *path = strut_arena_format(&arena, "%s/%s", directory, name);
  FILE *stream = NULL;
  strut_status status = STRUT_OK;
  if (buffer->failed || !path) {
    status = strut_no_memory(error, "while writing files");
  } else {
    errno = 0;
    stream = fopen(path, "wb");
    bool good = stream && fwrite(buffer->text, 1, buffer->length, stream) == buffer->length;
    if (stream && fclose(stream) != 0) good = false;
    char reason[128] = "";
    if (!good && strerror_r(errno, reason, sizeof reason) != 0) reason[0] = '\0';
    if (!good)
      status = strut_fail(error, STRUT_FILE_TROUBLE, "cannot write '%s': %s", name, reason);
  }
  buffer->length = 0;
  strut_arena_free(&arena);
  return status;
}

static strut_status write_frames(const char *stage, const strut_model *model,
                                 const strut_trajectory *motion, const strut_vtk_written *written,
                                 strut_buffer *buffer, strut_error *error) {
  vtk_frame frame;
  strut_status status = STRUT_OK;
  if (!vtk_frame_create(&frame, model, motion))
    status = strut_no_memory(error, "while writing files");
  for (size_t i = 0; i < written->frames && status == STRUT_OK; i++) {
    char name[FRAME_NAME];
    vtk_frame_write(&frame, i * written->every, buffer);
    status = write_text(stage, frame_name(i, name), buffer, error);
  }
  vtk_frame_free(&frame);
  return status;
}

static strut_status write_list(const char *stage, const strut_model *model,
                               const strut_trajectory *motion, const strut_vtk_written *written,
                               strut_buffer *buffer, strut_error *error) {
  strut_buffer_add(buffer,
                   "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
                   "byte_order=\"LittleEndian\">\n<Collection>\n");
  for (size_t i = 0; i < written->frames; i++) {
    char name[FRAME_NAME], time[STRUT_NUMBER_TEXT];
    strut_number_text(motion->time ? motion->time[i * written->every] : 0, time);
    strut_buffer_add(buffer, "<DataSet timestep=\"%s\" part=\"0\" file=\"%s\"/>\n", time,
                     frame_name(i, name));
    if (strut_scene_has_ground(model->scene))
      strut_buffer_add(buffer, "<DataSet timestep=\"%s\" part=\"1\" file=\"%s\"/>\n", time,
                       ground_name);
  }
  strut_buffer_add(buffer, "</Collection>\n</VTKFile>\n");
  return write_text(stage, list_name, buffer, error);
}

/* The extent of the motion, extended by its size on either side. */
static strut_status write_ground(const char *stage, const strut_model *model,
                                 const strut_trajectory *motion, strut_buffer *buffer,
                                 strut_error *error) {
  size_t count = motion->frames * motion->node_count;
  double low = (double)INFINITY, high = -(double)INFINITY;
  if (!strut_scene_has_ground(model->scene)) return STRUT_OK;
  for (size_t i = 0; i < count; i++) {
    double x = motion->position[2 * i];
    if (!isfinite(x)) continue;
    low = fmin(low, x);
    high = fmax(high, x);
  }
  if (!(low <= high)) low = high = 0;
  if (!model->scene->ground_count) {
    vtk_ground_write(model, low - model->size, high + model->size, buffer);
  } else {
    const double middle[2] = {0.5 * (low + high), model->start[1]};
    if (!vtk_surfaces_write(model, middle, high - low + 2.0 * model->size, buffer))
      return strut_no_memory(error, "while writing files");
  }
  return write_text(stage, ground_name, buffer, error);
}

static strut_status write_all(const char *stage, const strut_model *model,
                              const strut_trajectory *motion, const strut_vtk_written *written,
                              strut_error *error) {
  strut_buffer buffer = {0};
  strut_c_locale locale = strut_c_locale_enter();
  strut_status status = write_frames(stage, model, motion, written, &buffer, error);
  if (status == STRUT_OK) status = write_ground(stage, model, motion, &buffer, error);
  if (status == STRUT_OK) status = write_list(stage, model, motion, written, &buffer, error);
  strut_c_locale_leave(locale);
  strut_release(buffer.text);
  return status;
}

strut_status strut_vtk_write(const char *directory, const strut_model *model,
                             const strut_trajectory *motion, strut_vtk_written *written,
                             strut_error *error) {
  strut_results results = {0};
  strut_arena arena = {0};
  size_t most = STRUT_VTK_MOST_FRAMES;
  written->every = motion->frames > most ? (motion->frames + most - 1) / most : 1;
  written->frames = (motion->frames + written->every - 1) / written->every;
  const char **names = file_names(directory, written->frames, &arena);
  if (!names) return strut_no_memory(error, "while writing files");
  strut_status status = strut_results_begin_named(&results, directory, names, error);
  if (status == STRUT_OK) {
    status = write_all(results.stage, model, motion, written, error);
    if (status == STRUT_OK) {
      status = strut_results_commit(&results, error);
    } else {
      strut_results_abandon(&results);
    }
  }
  strut_arena_free(&arena);
  return status;
}
