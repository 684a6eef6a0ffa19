// SPDX-License-Identifier: MIT
// sagitta cast: a table of rays in, a table of hits out. Rays are read, traced and written in rounds, so that
// the memory does not grow with the table: each round's rays go to the batch queries, then pieces of the
// round are turned into rows side by side, each into a buffer of its own, and the buffers are written in
// order.
#include "formats/hit_table.h"
#include "formats/ray_table.h"
#include "tool.h"

#include <math.h>
#include <sagitta/solid.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "usage: sagitta cast FILE --rays RAYS [-o HITS] [OPTIONS]\n\n"
    "Sends the rays of a table into the geometry of FILE (a pbrt-v4 scene or any mesh Assimp reads) and "
    "writes what\n"
    "they hit. Numbers are double precision throughout.\n\n"
    "  -r, --rays RAYS      CSV or NumPy .npy (told apart by content); - is the standard input.\n"
    "                       CSV: ox,oy,oz,dx,dy,dz[,tmin,tmax] a line; a header with these names, blank "
    "lines and\n"
    "                       # comments may be there. .npy: float64 (or float32), N x 6 or N x 8.\n"
    "                       Without tmin and tmax a ray reaches from 0 to inf. Directions have any length "
    "but 0\n"
    "  -o, --output HITS    .npy (a structured array), else CSV; -, the default: CSV on the standard output\n"
    "      --query Q        closest (default), any, all, count or spans: see below\n"
    "      --threads N      as many threads; 0, the default: one a core. The hits do not depend on it\n"
    "  -q, --quiet          no progress, no warnings; errors only\n"
    "  -h, --help           this text\n\n"
    "Columns:\n"
    "  closest  ray,hit,t,x,y,z,nx,ny,nz,u,v,geometry,primitive,instance   the nearest hit, a row for each "
    "ray\n"
    "  all      the same, a row for every crossing, in order of t; a ray without any has one row, with hit "
    "0\n"
    "  any      ray,hit      whether there is any hit in [tmin, tmax]; the quickest\n"
    "  count    ray,count    how many crossings there are\n"
    "  spans    ray,hit,t_enter,t_leave,length,geometry_enter,primitive_enter,geometry_leave,"
    "primitive_leave,instance\n"
    "           a row for every interval of [tmin, tmax] within a closed geometry or solid, in order of "
    "t_enter; a ray\n"
    "           without any has one row, with hit 0 and length 0\n\n"
    "  ray        the ray's number, from 0\n"
    "  hit        1 or 0. A miss has t inf, the other numbers nan, the ids -1\n"
    "  t          in lengths of the direction: the point is o + t d\n"
    "  x,y,z      the point; nx,ny,nz the surface's unit normal there (geometric; not turned to the ray)\n"
    "  u,v        texture coordinates\n"
    "  geometry   number of the geometry in its scene, primitive: of the triangle (or part) in the geometry\n"
    "  instance   number of the outermost instance passed through; -1 outside of instances\n"
    "  length     of the interval, in the scene's unit; where it begins or ends with the ray itself, the "
    "primitive\n"
    "             there is -1\n\n"
    "CSV has 17 significant digits, so that the very doubles come back. HITS appears whole or not at all.\n";

enum { QUERY_CLOSEST, QUERY_ANY, QUERY_ALL, QUERY_COUNT, QUERY_SPANS };

#define MAX_ROUND     65536u             // rays traced at once
#define MAX_PIECES    128u               // of a round, encoded side by side
#define BIG_ROUND     ((size_t)64 << 20) // bytes of rows; `all` and `spans` take fewer rays at once beyond
#define KEPT_CAPACITY ((size_t)4 << 20)  // a piece's larger buffers are given back

// The rows of some consecutive rays, and room for one ray's crossings or spans.
typedef struct piece {
    char *bytes;
    size_t size, capacity;
    sag_hit *hits;
    size_t hit_capacity;
    sag_span *spans;
    size_t span_capacity;
    uint64_t row_count, hit_count;
    bool out_of_memory;
} piece;

typedef struct cast {
    const sag_context *context;
    const sag_scene *scene;
    int query;
    sagi_hit_table table;
    // this round
    const sag_ray *rays;
    size_t ray_count, rays_per_piece;
    uint64_t first_ray;
    // all rounds
    size_t round_size;
    uint64_t hit_count;
    sag_hit *hits;  // closest
    bool *occluded; // any
    piece pieces[MAX_PIECES];
} cast;

// Room for so many more bytes, kept what is there.
static bool reserve_bytes(const cast *c, piece *p, size_t more) {
    if (p->size + more <= p->capacity) return true;
    const size_t capacity = 2 * p->capacity > p->size + more ? 2 * p->capacity : p->size + more;
    char *bytes = sag_allocate(c->context, capacity);
    if (!bytes) return false;
    if (p->size) memcpy(bytes, p->bytes, p->size);
    sag_release(c->context, p->bytes, p->capacity);
    p->bytes = bytes;
    p->capacity = capacity;
    return true;
}

static bool reserve_hits(const cast *c, piece *p, size_t count) {
    if (count <= p->hit_capacity) return true;
    sag_release(c->context, p->hits, p->hit_capacity * sizeof *p->hits);
    p->hit_capacity = 0;
    p->hits = sag_allocate(c->context, count * sizeof *p->hits);
    if (p->hits) p->hit_capacity = count;
    return p->hits != NULL;
}

static bool reserve_spans(const cast *c, piece *p, size_t count) {
    if (count <= p->span_capacity) return true;
    sag_release(c->context, p->spans, p->span_capacity * sizeof *p->spans);
    p->span_capacity = 0;
    p->spans = sag_allocate(c->context, count * sizeof *p->spans);
    if (p->spans) p->span_capacity = count;
    return p->spans != NULL;
}

static int64_t id_of(uint32_t id) { return id != SAG_INVALID_ID ? (int64_t)id : -1; }

static int64_t instance_of(const sag_hit *hit) {
    return hit->instance_depth > 0 ? (int64_t)hit->instance_path[0] : -1;
}

static sagi_hit_row row_of_hit(const cast *c, uint64_t number, const sag_ray *ray, const sag_hit *hit) {
    sag_surface s;
    sag_surface_at(c->scene, ray, hit, &s);
    return (sagi_hit_row){.ray = number,
                          .hit = true,
                          .t = hit->t,
                          .position = s.position,
                          .normal = s.geometric_normal,
                          .u = s.u,
                          .v = s.v,
                          .geometry = hit->geometry,
                          .primitive = hit->primitive,
                          .instance = instance_of(hit)};
}

// In the scene's unit. The direction may be so short or long that its length alone has no square.
static double length_of(const sag_ray *ray, const sag_span *span) {
    int exponent;
    (void)frexp(sag_max_component(sag_abs(ray->direction)), &exponent);
    const sag_vec3 d = {ldexp(ray->direction.x, -exponent), ldexp(ray->direction.y, -exponent),
                        ldexp(ray->direction.z, -exponent)};
    return ldexp(span->leave.t - span->enter.t, exponent) * sag_length(d);
}

static sagi_hit_row row_of_span(uint64_t number, const sag_ray *ray, const sag_span *span) {
    return (sagi_hit_row){.ray = number,
                          .hit = true,
                          .t = span->enter.t,
                          .geometry = id_of(span->enter.geometry),
                          .primitive = id_of(span->enter.primitive),
                          .instance = instance_of(&span->enter),
                          .t_leave = span->leave.t,
                          .length = length_of(ray, span),
                          .geometry_leave = id_of(span->leave.geometry),
                          .primitive_leave = id_of(span->leave.primitive)};
}

// Room for the row is the caller's care.
static void add_row(const cast *c, piece *p, const sagi_hit_row *row) {
    p->size += sagi_hit_encode(&c->table, row, p->bytes + p->size);
    p->row_count++;
}

static bool add_crossings(const cast *c, piece *p, uint64_t number, const sag_ray *ray) {
    size_t count = sag_intersect_all(c->scene, ray, p->hits, p->hit_capacity);
    if (count > p->hit_capacity) {
        if (!reserve_hits(c, p, count)) return false;
        count = sag_intersect_all(c->scene, ray, p->hits, p->hit_capacity);
    }
    if (!reserve_bytes(c, p, (count + 1) * SAGI_HIT_ROW_BYTES)) return false;
    for (size_t i = 0; i < count; i++) {
        const sagi_hit_row row = row_of_hit(c, number, ray, &p->hits[i]);
        add_row(c, p, &row);
    }
    p->hit_count += count;
    if (count == 0) {
        const sagi_hit_row miss = sagi_hit_miss(number);
        add_row(c, p, &miss);
    }
    return true;
}

static bool add_spans(const cast *c, piece *p, uint64_t number, const sag_ray *ray) {
    size_t count = sag_scene_spans(c->scene, ray, p->spans, p->span_capacity);
    if (count > p->span_capacity) {
        if (!reserve_spans(c, p, count)) return false;
        count = sag_scene_spans(c->scene, ray, p->spans, p->span_capacity);
    }
    if (!reserve_bytes(c, p, (count + 1) * SAGI_HIT_ROW_BYTES)) return false;
    for (size_t i = 0; i < count; i++) {
        const sagi_hit_row row = row_of_span(number, ray, &p->spans[i]);
        add_row(c, p, &row);
    }
    p->hit_count += count;
    if (count == 0) {
        const sagi_hit_row none = sagi_hit_no_span(number);
        add_row(c, p, &none);
    }
    return true;
}

static void encode_piece(void *argument, size_t index) {
    cast *c = argument;
    piece *p = &c->pieces[index];
    const size_t first = index * c->rays_per_piece;
    size_t last = first + c->rays_per_piece;
    if (last > c->ray_count) last = c->ray_count;
    p->size = 0;
    p->row_count = p->hit_count = 0;
    p->out_of_memory = !reserve_bytes(c, p, (last - first) * SAGI_HIT_ROW_BYTES);
    for (size_t i = first; i < last && !p->out_of_memory; i++) {
        const uint64_t number = c->first_ray + i;
        sagi_hit_row row = sagi_hit_miss(number);
        switch (c->query) {
        case QUERY_CLOSEST:
            if (c->hits[i].geometry != SAG_INVALID_ID) row = row_of_hit(c, number, &c->rays[i], &c->hits[i]);
            break;
        case QUERY_ANY: row.hit = c->occluded[i]; break;
        case QUERY_COUNT: row.count = sag_count_crossings(c->scene, &c->rays[i]); break;
        case QUERY_SPANS: p->out_of_memory = !add_spans(c, p, number, &c->rays[i]); continue;
        default: p->out_of_memory = !add_crossings(c, p, number, &c->rays[i]); continue;
        }
        p->hit_count += c->query == QUERY_COUNT ? row.count : row.hit;
        add_row(c, p, &row);
    }
}

// Whether a ray may have any number of rows.
static bool has_many_rows(int query) { return query == QUERY_ALL || query == QUERY_SPANS; }

// Traces the round and writes its rows.
static sag_status cast_round(cast *c, sag_error *error) {
    if (c->query == QUERY_CLOSEST) sag_intersect_batch(c->scene, c->rays, c->hits, c->ray_count);
    if (c->query == QUERY_ANY) sag_occluded_batch(c->scene, c->rays, c->occluded, c->ray_count);
    c->rays_per_piece = c->round_size > MAX_PIECES ? c->round_size / MAX_PIECES : 1;
    const size_t piece_count = (c->ray_count + c->rays_per_piece - 1) / c->rays_per_piece;
    sag_parallel_for(c->context, piece_count, encode_piece, c);
    size_t written = 0;
    for (size_t i = 0; i < piece_count; i++) {
        piece *p = &c->pieces[i];
        if (p->out_of_memory) return sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for the hits");
        sag_status status = sagi_hit_table_append(&c->table, p->bytes, p->size, p->row_count, error);
        if (status != SAG_OK) return status;
        written += p->size;
        c->hit_count += p->hit_count;
        if (p->capacity > KEPT_CAPACITY) {
            sag_release(c->context, p->bytes, p->capacity);
            p->bytes = NULL;
            p->capacity = 0;
        }
    }
    if (has_many_rows(c->query) && written > BIG_ROUND && c->round_size > 1) c->round_size /= 2;
    if (has_many_rows(c->query) && written < BIG_ROUND / 4 && c->round_size < MAX_ROUND) c->round_size *= 2;
    return interrupt_flag ? sag_error_set(error, SAG_ERROR_CANCELLED, "interrupted") : SAG_OK;
}

static sag_status cast_all(cast *c, sagi_ray_reader *reader, progress *bar, sag_error *error) {
    for (;;) {
        const sag_ray *rays;
        size_t count;
        sag_status status = sagi_ray_reader_next(reader, &rays, &count, error);
        if (status != SAG_OK || count == 0) return status;
        for (size_t done = 0; done < count; done += c->ray_count) {
            c->rays = rays + done;
            c->ray_count = count - done < c->round_size ? count - done : c->round_size;
            status = cast_round(c, error);
            if (status != SAG_OK) return status;
            c->first_ray += c->ray_count;
        }
        if (c->table.is_stdout) status = sagi_hit_table_flush(&c->table, error);
        if (status != SAG_OK) return status;
        progress_update(bar, sagi_ray_reader_fraction(reader), (double)c->first_ray);
    }
}

static void release_buffers(cast *c) {
    for (size_t i = 0; i < MAX_PIECES; i++) {
        sag_release(c->context, c->pieces[i].bytes, c->pieces[i].capacity);
        sag_release(c->context, c->pieces[i].hits, c->pieces[i].hit_capacity * sizeof *c->pieces[i].hits);
        sag_release(c->context, c->pieces[i].spans, c->pieces[i].span_capacity * sizeof *c->pieces[i].spans);
    }
    sag_release(c->context, c->hits, MAX_ROUND * sizeof *c->hits);
    sag_release(c->context, c->occluded, MAX_ROUND * sizeof *c->occluded);
}

static sag_status reserve_buffers(cast *c, sag_error *error) {
    if (c->query == QUERY_CLOSEST) c->hits = sag_allocate(c->context, MAX_ROUND * sizeof *c->hits);
    if (c->query == QUERY_ANY) c->occluded = sag_allocate(c->context, MAX_ROUND * sizeof *c->occluded);
    const bool good = (c->query != QUERY_CLOSEST || c->hits) && (c->query != QUERY_ANY || c->occluded);
    return good ? SAG_OK : sag_error_set(error, SAG_ERROR_MEMORY, "out of memory for the hits");
}

typedef struct cast_options {
    const char *file, *rays, *output;
    uint64_t threads;
    int query;
    bool quiet;
} cast_options;

static void say_what_was_done(const cast *c, double seconds, const char *output) {
    char rays[TEXT_BYTES], hits[TEXT_BYTES], time[TEXT_BYTES], rate[TEXT_BYTES];
    static const char *const names[] = {"hit", "hit", "crossings", "crossings", "spans"};
    fprintf(stderr, "%s: %s ray%s, %s %s, in %s (%s)\n", output, text_count(rays, c->first_ray),
            c->first_ray == 1 ? "" : "s", text_count(hits, c->hit_count), names[c->query],
            text_seconds(time, seconds), text_rate(rate, (double)c->first_ray, seconds, "rays"));
}

static sag_status cast_rays(const cast_options *o, sag_world *world, sag_error *error) {
    static const sagi_hit_columns columns[] = {SAGI_HIT_FULL, SAGI_HIT_FLAG, SAGI_HIT_FULL, SAGI_HIT_COUNT,
                                               SAGI_HIT_SPAN};
    cast c = {.context = sag_world_context(world),
              .scene = sag_world_scene(world),
              .query = o->query,
              .round_size = has_many_rows(o->query) ? 256 : MAX_ROUND};
    sagi_ray_reader *reader = NULL;
    sag_status status = sagi_ray_reader_open(c.context, o->rays, &reader, error);
    if (status != SAG_OK) return status;
    interrupt_catch();
    sagi_ray_reader_set_stop(reader, &interrupt_flag);
    if (strcmp(o->rays, "-") == 0 && isatty(STDIN_FILENO) && !o->quiet) {
        fprintf(stderr, "rays, one a line (ox,oy,oz,dx,dy,dz); Ctrl-D ends:\n");
    }
    const double start = clock_seconds();
    progress bar;
    // Rows that scroll over the terminal and a bar would only disturb each other.
    const bool to_terminal = strcmp(o->output, "-") == 0 && isatty(STDOUT_FILENO);
    progress_begin(&bar, "casting", "rays", o->quiet || to_terminal);
    status = sagi_hit_table_open(&c.table, o->output, columns[o->query], error);
    if (status == SAG_OK) {
        status = reserve_buffers(&c, error);
        if (status == SAG_OK) status = cast_all(&c, reader, &bar, error);
        if (status == SAG_OK) status = sagi_hit_table_commit(&c.table, error);
        if (status != SAG_OK) sagi_hit_table_discard(&c.table);
    }
    progress_end(&bar);
    if (status == SAG_OK && !o->quiet) say_what_was_done(&c, clock_seconds() - start, c.table.name);
    release_buffers(&c);
    sagi_ray_reader_close(reader);
    return status;
}

static int cast_file(const cast_options *o) {
    sag_context *context = session_open(o->threads, o->quiet);
    if (!context) return TOOL_FAILED;
    sag_error error = {0};
    sag_world *world = session_load(context, o->file, o->quiet, NULL, NULL, &error);
    const sag_status status = world ? cast_rays(o, world, &error) : error.status;
    sag_world_destroy(world);
    const int result = status == SAG_OK ? TOOL_OK : report_error(&error);
    session_close(context);
    return result;
}

static int run(const tool_command *command, int argc, char **argv) {
    static const char *const queries[] = {"closest", "any", "all", "count", "spans", NULL};
    cast_options o = {.output = "-"};
    const option options[] = {
        {.name = "rays", .letter = 'r', .kind = OPTION_TEXT, .target = &o.rays},
        {.name = "output", .letter = 'o', .kind = OPTION_TEXT, .target = &o.output},
        {.name = "query", .kind = OPTION_CHOICE, .target = &o.query, .choices = queries},
        {.name = "threads", .kind = OPTION_COUNT, .target = &o.threads, .minimum = 0, .maximum = 4096},
        {.name = "quiet", .letter = 'q', .kind = OPTION_FLAG, .target = &o.quiet},
    };
    const int count = options_parse(command, options, sizeof options / sizeof *options, argc, argv);
    if (count == -2) return TOOL_OK;
    if (count < 0) return TOOL_USAGE;
    if (count == 0) return usage_error(command->name, "which file?");
    if (count > 1) return usage_error(command->name, "one file at a time: '%s' is too much", argv[1]);
    if (!o.rays)
        return usage_error(command->name,
                           "which rays? --rays RAYS.csv, RAYS.npy or - for the standard input");
    o.file = argv[0];
    return cast_file(&o);
}

const tool_command tool_cast = {"cast", "send a table of rays, get a table of hits", help, run};
