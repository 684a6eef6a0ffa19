// SPDX-License-Identifier: MIT
// bench-rays: what its files share. A model (triangles or spheres) and sets of rays; Sagitta (subject.c) and
// Embree (peer.c) trace them in turns (measure.c); where they disagree, exact arithmetic says who is right
// (settle.c, exact.c); tables.c and json.c tell it.
//
// Every coordinate of every ray is a float, held in double where Sagitta reads it: both sides answer the very
// same question.
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

#include <sagitta/scene.h>

// ---- model.c, terrain.c, balls.c: what is shot at. Triangles, or spheres when sphere_count is not 0.
typedef struct model {
    char name[64];
    float *positions;    // x y z of each vertex
    uint32_t *triangles; // three corners each
    uint32_t vertex_count, triangle_count;
    float *spheres; // x y z radius of each
    uint32_t sphere_count;
    sag_vec3 center; // of the bounding box
    double radius;   // half its diagonal
} model;

bool model_load(model *m, const char *path);
void model_make_terrain(model *m, uint32_t triangle_count);
void model_make_random_spheres(model *m, uint32_t count);
void model_make_flake(model *m, int depth);
void model_measure(model *m); // center and radius, from the rest
void model_free(model *m);
static inline uint32_t model_primitives(const model *m) {
    return m->sphere_count ? m->sphere_count : m->triangle_count;
}

// ---- rays.c: what is shot.
typedef struct ray_set {
    const char *name;
    bool occluded; // any hit, not the closest
    bool packets;  // neighbours are together: 16 rays make a 4×4 tile
    sag_ray *rays;
    size_t count;
} ray_set;

enum { SET_CAMERA, SET_BOUNCE, SET_SHADOW, SET_CHORD, SET_COUNT };
extern const char *const set_names[SET_COUNT];

// Fills sets[] with rays; those whose bit is not in `wanted` stay empty. `scene` holds the model. The camera
// has side × side pixels, and there are as many chords.
void sets_make(ray_set sets[SET_COUNT], unsigned wanted, const model *m, const sag_scene *scene,
               uint32_t side);
void sets_free(ray_set sets[SET_COUNT]);

// What one side said about a ray: t and primitive of the hit. For an any-hit ray only whether.
typedef struct answer {
    double t;
    uint32_t primitive; // SAG_INVALID_ID: nothing
} answer;

// ---- crew.c: threads, time, memory.
double seconds_now(void);
// work(argument, first, end) on pieces of [0, count) by so many threads, the calling one included; seconds
// from start to the end of the last.
double crew_run(uint32_t threads, size_t count, void (*work)(void *argument, size_t first, size_t end),
                void *argument);
void *need(size_t bytes); // aligned to 64; the program ends when there is none
uint64_t random_next(uint64_t *state);
double random_unit(uint64_t *state); // [0, 1)

// ---- subject.c: Sagitta.
typedef struct subject_options {
    const char *isa; // NULL: the best
    const char *quality;
    uint32_t threads;
} subject_options;

typedef struct built {
    double seconds; // 0: not built
    double structure_bytes, geometry_bytes, peak_bytes;
    double sah; // NAN: not known
} built;

typedef struct subject {
    sag_context *context;
    sag_scene *scene;
} subject;

// The qualities Sagitta can build at; NULL ends the list. The first is the default.
extern const char *const subject_qualities[];
subject subject_create(const model *m, const subject_options *options, built *b);
void subject_destroy(subject *s);

// A set of rays with room for Sagitta's answers.
typedef struct subject_run {
    const sag_scene *scene;
    const ray_set *set;
    uint32_t threads;
    sag_hit *hits;
    bool *dark;
} subject_run;

void subject_run_init(subject_run *r, const subject *s, const ray_set *set, uint32_t threads);
void subject_run_clear(subject_run *r);
void subject_reset(void *run);    // as if never traced
double subject_single(void *run); // seconds; a call a ray
double subject_batch(void *run);  // seconds; one call for all
void subject_answers(const subject_run *r, answer *answers);

// ---- stages.c: how often each stage of the traversal runs, a ray of this set; single calls on one thread.
void print_stages(const subject *s, const ray_set *set, subject_run *run);

// ---- peer.c: Embree, where it was found; without it peer_name returns NULL and nothing else is called.
typedef struct peer peer;
enum { PEER_LOW, PEER_MEDIUM, PEER_HIGH, PEER_QUALITY_COUNT };

const char *peer_name(void); // "Embree 3.13.5"
peer *peer_create(const model *m, int quality, bool robust, uint32_t threads, built *b);
void peer_destroy(peer *p);

typedef struct peer_run peer_run;
// How the rays are handed over: one by one; sixteen at a time; so, and said to be coherent.
typedef enum peer_call { PEER_SINGLE, PEER_PACKET, PEER_COHERENT } peer_call;
peer_run *peer_run_create(const peer *p, const ray_set *set, uint32_t threads, peer_call call);
void peer_run_destroy(peer_run *r);
void peer_reset(void *run);
double peer_trace(void *run);
void peer_answers(const peer_run *r, answer *answers);
answer peer_closest(const peer *p, const sag_ray *ray);

// ---- measure.c: one set of rays, every contender.
enum {
    SAGITTA_SINGLE,
    SAGITTA_BATCH,
    EMBREE_FAST,
    EMBREE_ROBUST,
    EMBREE_PACKET,
    EMBREE_COHERENT,
    CONTENDER_COUNT
};

// Of one kind of Embree: how often Sagitta and it differ, and of these, how often it is wrong and how often
// both are right.
typedef struct dispute {
    size_t disagree, wrong, ties;
} dispute;

typedef struct settled {
    dispute fast, robust;
    size_t sagitta_wrong;
    size_t searched, unsearched; // rays for which every primitive was asked, and for which there was no time
} settled;

typedef struct result {
    char model[64], isa[16];
    const char *set, *quality;
    bool spheres;
    uint32_t threads;
    size_t rays, met;
    double mrays[CONTENDER_COUNT]; // millions of rays a second; 0: did not take part
    size_t batch_differs;          // rays to which batch and single call answer differently
    size_t planted;                // answers of Sagitta's that were spoiled on purpose
    settled settled;
} result;

// Every contender once a repeat, each time another one first; the median counts. fast and robust may be NULL.
// `plant`: spoil some answers, to see them found.
void measure_set(result *r, const model *m, const ray_set *set, const subject *s, const peer *fast,
                 const peer *robust, uint32_t repeats, bool plant);

// ---- settle.c: who is right where answers differ.
settled settle(const model *m, const ray_set *set, const sag_scene *scene, const peer *fast,
               const peer *robust, const answer *of_sagitta, const answer *of_fast, const answer *of_robust);
// Spoils some of Sagitta's answers; returns how many.
size_t plant_errors(const model *m, const ray_set *set, answer *answers);

// ---- tables.c, summary.c, json.c
typedef struct build_result {
    char model[64];
    const char *quality;
    uint32_t threads, primitives;
    built sagitta, embree;
} build_result;

typedef struct report {
    result *results;
    size_t result_count;
    build_result *builds;
    size_t build_count;
} report;

void report_add_result(report *r, const result *added);
void report_add_build(report *r, const build_result *added);
void report_free(report *r);
void print_build(const build_result *builds, size_t count);
void print_set_heading(uint32_t threads, const char *isa, const char *quality);
void print_set(const result *r);
void print_set_means(const result *results, size_t count);
void print_summary(const report *r);
double ratio_of(const result *r, int contender, int base); // 0: one of them is missing
// The geometric mean of a ratio over those results that have it; 0: none has.
double mean_ratio(const result *results, size_t count, int contender, int base);
bool json_write(const report *r, const char *path);

#endif
