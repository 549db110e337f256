/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/output/vtk_frame.h"

#include <math.h>
#include <string.h>

#include "engine/output/base64.h"

static const char head[] =
    "<?xml version=\"1.0\"?>\n"
    "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
    "header_type=\"UInt64\">\n<PolyData>\n";
static const char tail[] = "</Piece>\n</PolyData>\n</VTKFile>\n";

bool strut_vtk_frame_create(strut_vtk_frame *frame, const strut_model *model,
                            const strut_trajectory *motion) {
  size_t nodes = model->scene->node_count, members = model->scene->member_count;
  size_t whole = 2 * members > nodes ? 2 * members : nodes;
  *frame = (strut_vtk_frame){.model = model, .motion = motion};
  frame->points = strut_arena_allocate(&frame->arena, 3 * nodes, sizeof(double));
  frame->cells = strut_arena_allocate(&frame->arena, members, sizeof(double));
  frame->whole = strut_arena_allocate(&frame->arena, whole, sizeof(int32_t));
  return frame->points && frame->cells && frame->whole;
}

void strut_vtk_frame_free(strut_vtk_frame *frame) { strut_arena_free(&frame->arena); }

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

/* One text of an array of them: its bytes as numbers up to the 0 that ends it. */
static void add_name(strut_buffer *buffer, const char *text) {
  for (; *text; text++) strut_buffer_add(buffer, "%d ", (unsigned char)*text);
  strut_buffer_add(buffer, "0 ");
}

static void add_fields(const strut_vtk_frame *frame, size_t i, strut_buffer *buffer) {
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

/* Vectors of the plane, with an origin to take off or NULL, into points. */
static void spread(strut_vtk_frame *frame, const double *plane, const double *origin) {
  size_t nodes = frame->model->scene->node_count;
  for (size_t k = 0; k < nodes; k++) {
    frame->points[3 * k] = plane[2 * k] - (origin ? origin[2 * k] : 0);
    frame->points[3 * k + 1] = plane[2 * k + 1] - (origin ? origin[2 * k + 1] : 0);
    frame->points[3 * k + 2] = 0;
  }
}

static void gather_contact(strut_vtk_frame *frame, size_t i) {
  const strut_trajectory *motion = frame->motion;
  const strut_contact_table *table = &frame->model->contacts;
  const double *force = motion->contact + 2 * motion->contact_count * i;
  memset(frame->points, 0, 3 * frame->model->scene->node_count * sizeof *frame->points);
  for (size_t k = 0; k < motion->contact_count; k++) {
    double *to = frame->points + 3 * motion->contact_node[k];
    for (int axis = 0; axis < 2; axis++)
      to[axis] = force[2 * k] * table->normal[axis] + force[2 * k + 1] * table->tangent[axis];
  }
}

static void add_point_data(strut_vtk_frame *frame, size_t i, strut_buffer *buffer) {
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
static void gather_lengths(strut_vtk_frame *frame, size_t i) {
  const strut_scene *scene = frame->model->scene;
  const strut_trajectory *motion = frame->motion;
  const double *q = motion->position + 2 * scene->node_count * i;
  for (size_t k = 0; k < scene->member_count; k++) {
    const int32_t *node = scene->members[k].node;
    frame->cells[k] = motion->length ? motion->length[scene->member_count * i + k]
                                     : hypot(q[2 * node[1]] - q[2 * node[0]],
                                             q[2 * node[1] + 1] - q[2 * node[0] + 1]);
  }
}

static void add_cell_data(strut_vtk_frame *frame, size_t i, strut_buffer *buffer) {
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

/* Cells of so many points each, in whole numbers from `points` on. */
static void add_cells(strut_vtk_frame *frame, const char *name, size_t cells, int each,
                      strut_buffer *buffer) {
  const strut_member *members = frame->model->scene->members;
  for (size_t k = 0; k < cells; k++) {
    if (each == 1) frame->whole[k] = (int32_t)k;
    for (int end = 0; each == 2 && end < 2; end++)
      frame->whole[2 * k + (size_t)end] = members[k].node[end];
  }
  strut_buffer_add(buffer, "<%s>\n", name);
  add_array(buffer, "Int32", "connectivity", 1, frame->whole, cells * (size_t)each);
  for (size_t k = 0; k < cells; k++) frame->whole[k] = (int32_t)(k + 1) * each;
  add_array(buffer, "Int32", "offsets", 1, frame->whole, cells);
  strut_buffer_add(buffer, "</%s>\n", name);
}

void strut_vtk_frame_write(strut_vtk_frame *frame, size_t i, strut_buffer *buffer) {
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
    add_cells(frame, "Lines", members, 2, buffer);
  } else {
    add_cells(frame, "Verts", nodes, 1, buffer);
  }
  strut_buffer_add(buffer, "%s", tail);
}

void strut_vtk_ground_write(const strut_model *model, double low, double high,
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
