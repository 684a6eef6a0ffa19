// SPDX-License-Identifier: MIT
// Embree 3 or 4 on the same model and rays: single rays (rtcIntersect1, rtcOccluded1) and packets of sixteen
// (rtcIntersect16), each call's rays laid out beforehand as the call wants them. Embree writes its answer
// over the ray, so the rays are copied afresh before each repeat; that is not timed.
#include "bench.h"

#ifdef BENCH_EMBREE
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#ifdef __SSE__
#include <xmmintrin.h>
#endif
#if BENCH_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

enum { WIDTH = 16 };

struct peer {
    RTCDevice device;
    RTCScene scene;
    atomic_llong bytes, peak;
};

struct peer_run {
    RTCScene scene;
    const ray_set *set;
    uint32_t threads;
    bool coherent;
    struct RTCRayHit *fresh, *one;        // single, closest
    struct RTCRay *fresh_any, *any;       // single, any
    struct RTCRayHit16 *fresh16, *packet; // packets
};

const char *peer_name(void) { return "Embree " RTC_VERSION_STRING; }

// Every allocation and release of the device, its buffers included. Called from any thread.
static bool count_bytes(void *counter, ssize_t bytes, bool after) {
    (void)after;
    peer *p = counter;
    long long now = atomic_fetch_add(&p->bytes, bytes) + bytes, most = atomic_load(&p->peak);
    while (now > most && !atomic_compare_exchange_weak(&p->peak, &most, now)) {
    }
    return true;
}

static RTCGeometry triangles_of(RTCDevice device, const model *m) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void *v = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, m->vertex_count);
    void *t = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, m->triangle_count);
    if (v != NULL) memcpy(v, m->positions, (size_t)m->vertex_count * 12);
    if (t != NULL) memcpy(t, m->triangles, (size_t)m->triangle_count * 12);
    return g;
}

static RTCGeometry spheres_of(RTCDevice device, const model *m) {
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    void *v = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, m->sphere_count);
    if (v != NULL) memcpy(v, m->spheres, (size_t)m->sphere_count * 16);
    return g;
}

peer *peer_create(const model *m, int quality, bool robust, uint32_t threads, built *b) {
    static const enum RTCBuildQuality qualities[PEER_QUALITY_COUNT] = {
        RTC_BUILD_QUALITY_LOW, RTC_BUILD_QUALITY_MEDIUM, RTC_BUILD_QUALITY_HIGH};
    peer *p = need(sizeof *p);
    memset(p, 0, sizeof *p);
    char config[64];
    snprintf(config, sizeof config, "threads=%u", threads);
    p->device = rtcNewDevice(config);
    if (p->device == NULL) {
        fprintf(stderr, "bench-rays: Embree makes no device\n");
        exit(1);
    }
    rtcSetDeviceMemoryMonitorFunction(p->device, count_bytes, p);
    p->scene = rtcNewScene(p->device);
    rtcSetSceneBuildQuality(p->scene, qualities[quality]);
    rtcSetSceneFlags(p->scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    RTCGeometry g = m->sphere_count > 0 ? spheres_of(p->device, m) : triangles_of(p->device, m);
    rtcSetGeometryBuildQuality(g, qualities[quality]);
    rtcCommitGeometry(g);
    rtcAttachGeometry(p->scene, g);
    rtcReleaseGeometry(g);
    double start = seconds_now();
    rtcCommitScene(p->scene);
    double seconds = seconds_now() - start;
    enum RTCError failure = rtcGetDeviceError(p->device);
    if (failure != RTC_ERROR_NONE) {
        fprintf(stderr, "bench-rays: Embree fails with error %d\n", (int)failure);
        exit(1);
    }
    double geometry =
        m->sphere_count > 0 ? 16.0 * m->sphere_count : 12.0 * ((double)m->vertex_count + m->triangle_count);
    *b = (built){.seconds = seconds,
                 .structure_bytes = (double)atomic_load(&p->bytes) - geometry,
                 .geometry_bytes = geometry,
                 .peak_bytes = (double)atomic_load(&p->peak),
                 .sah = NAN};
    return p;
}

void peer_destroy(peer *p) {
    if (p == NULL) return;
    rtcReleaseScene(p->scene);
    rtcReleaseDevice(p->device);
    free(p);
}

static struct RTCRay single_ray(const sag_ray *r) {
    return (struct RTCRay){.org_x = (float)r->origin.x,
                           .org_y = (float)r->origin.y,
                           .org_z = (float)r->origin.z,
                           .tnear = (float)r->t_min,
                           .dir_x = (float)r->direction.x,
                           .dir_y = (float)r->direction.y,
                           .dir_z = (float)r->direction.z,
                           .tfar = (float)r->t_max,
                           .mask = 0xFFFFFFFFu};
}

static struct RTCRayHit single_ray_hit(const sag_ray *r) {
    return (struct RTCRayHit){.ray = single_ray(r), .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
}

static void into_packet(struct RTCRayHit16 *packet, size_t lane, const sag_ray *r) {
    packet->ray.org_x[lane] = (float)r->origin.x;
    packet->ray.org_y[lane] = (float)r->origin.y;
    packet->ray.org_z[lane] = (float)r->origin.z;
    packet->ray.tnear[lane] = (float)r->t_min;
    packet->ray.dir_x[lane] = (float)r->direction.x;
    packet->ray.dir_y[lane] = (float)r->direction.y;
    packet->ray.dir_z[lane] = (float)r->direction.z;
    packet->ray.tfar[lane] = (float)r->t_max;
    packet->ray.mask[lane] = 0xFFFFFFFFu;
    packet->hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
}

static size_t packet_count(const ray_set *set) { return (set->count + WIDTH - 1) / WIDTH; }

peer_run *peer_run_create(const peer *p, const ray_set *set, uint32_t threads, peer_call call) {
    peer_run *r = need(sizeof *r);
    *r = (peer_run){.scene = p->scene, .set = set, .threads = threads, .coherent = call == PEER_COHERENT};
    if (call != PEER_SINGLE) {
        size_t bytes = packet_count(set) * sizeof *r->packet;
        r->fresh16 = memset(need(bytes), 0, bytes);
        r->packet = need(bytes);
        for (size_t i = 0; i < packet_count(set) * WIDTH; i++) // a last packet is filled up with its last ray
            into_packet(&r->fresh16[i / WIDTH], i % WIDTH, &set->rays[i < set->count ? i : set->count - 1]);
    } else if (set->occluded) {
        r->fresh_any = need(set->count * sizeof *r->any);
        r->any = need(set->count * sizeof *r->any);
        for (size_t i = 0; i < set->count; i++) r->fresh_any[i] = single_ray(&set->rays[i]);
    } else {
        r->fresh = need(set->count * sizeof *r->one);
        r->one = need(set->count * sizeof *r->one);
        for (size_t i = 0; i < set->count; i++) r->fresh[i] = single_ray_hit(&set->rays[i]);
    }
    peer_reset(r);
    return r;
}

void peer_run_destroy(peer_run *r) {
    if (r == NULL) return;
    free(r->fresh);
    free(r->one);
    free(r->fresh_any);
    free(r->any);
    free(r->fresh16);
    free(r->packet);
    free(r);
}

void peer_reset(void *run) {
    peer_run *r = run;
    if (r->packet != NULL) memcpy(r->packet, r->fresh16, packet_count(r->set) * sizeof *r->packet);
    if (r->any != NULL) memcpy(r->any, r->fresh_any, r->set->count * sizeof *r->any);
    if (r->one != NULL) memcpy(r->one, r->fresh, r->set->count * sizeof *r->one);
}

// The calls of both versions under one name each.
#if BENCH_EMBREE == 4
typedef struct RTCIntersectArguments closest_options;
typedef struct RTCOccludedArguments any_options;
static closest_options for_closest(bool coherent) {
    closest_options o;
    rtcInitIntersectArguments(&o);
    if (coherent) o.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    return o;
}
static any_options for_any(void) {
    any_options o;
    rtcInitOccludedArguments(&o);
    return o;
}
static inline void closest1(RTCScene s, closest_options *o, struct RTCRayHit *r) { rtcIntersect1(s, r, o); }
static inline void any1(RTCScene s, any_options *o, struct RTCRay *r) { rtcOccluded1(s, r, o); }
static inline void closest16(const int *valid, RTCScene s, closest_options *o, struct RTCRayHit16 *r) {
    rtcIntersect16(valid, s, r, o);
}
#else
typedef struct RTCIntersectContext closest_options;
typedef struct RTCIntersectContext any_options;
static closest_options for_closest(bool coherent) {
    closest_options o;
    rtcInitIntersectContext(&o);
    if (coherent) o.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return o;
}
static any_options for_any(void) { return for_closest(false); }
static inline void closest1(RTCScene s, closest_options *o, struct RTCRayHit *r) { rtcIntersect1(s, o, r); }
static inline void any1(RTCScene s, any_options *o, struct RTCRay *r) { rtcOccluded1(s, o, r); }
static inline void closest16(const int *valid, RTCScene s, closest_options *o, struct RTCRayHit16 *r) {
    rtcIntersect16(valid, s, o, r);
}
#endif

// Embree asks for denormals to be taken as 0 in every thread that calls it, since they may cost it time.
#ifdef __SSE__
static unsigned begin_without_denormals(void) {
    unsigned before = _mm_getcsr();
    _mm_setcsr(before | 0x8040); // flush to zero, denormals are zero
    return before;
}
static void end_without_denormals(unsigned before) { _mm_setcsr(before); }
#else
static unsigned begin_without_denormals(void) { return 0; }
static void end_without_denormals(unsigned before) { (void)before; }
#endif

static void closest_of(void *run, size_t first, size_t end) {
    const peer_run *r = run;
    unsigned mode = begin_without_denormals();
    closest_options options = for_closest(false);
    for (size_t i = first; i < end; i++) closest1(r->scene, &options, &r->one[i]);
    end_without_denormals(mode);
}

static void any_of(void *run, size_t first, size_t end) {
    const peer_run *r = run;
    unsigned mode = begin_without_denormals();
    any_options options = for_any();
    for (size_t i = first; i < end; i++) any1(r->scene, &options, &r->any[i]);
    end_without_denormals(mode);
}

static void packets_of(void *run, size_t first, size_t end) {
    const peer_run *r = run;
    unsigned mode = begin_without_denormals();
    _Alignas(64) int valid[WIDTH];
    for (int i = 0; i < WIDTH; i++) valid[i] = -1;
    closest_options options = for_closest(r->coherent);
    for (size_t i = first; i < end; i++) closest16(valid, r->scene, &options, &r->packet[i]);
    end_without_denormals(mode);
}

double peer_trace(void *run) {
    peer_run *r = run;
    if (r->packet != NULL) return crew_run(r->threads, packet_count(r->set), packets_of, r);
    return crew_run(r->threads, r->set->count, r->any != NULL ? any_of : closest_of, r);
}

void peer_answers(const peer_run *r, answer *answers) {
    for (size_t i = 0; i < r->set->count; i++)
        if (r->any != NULL) {
            answers[i] = (answer){0, r->any[i].tfar < 0 ? 0 : SAG_INVALID_ID};
        } else {
            bool met = r->one[i].hit.geomID != RTC_INVALID_GEOMETRY_ID;
            answers[i] = (answer){met ? (double)r->one[i].ray.tfar : INFINITY,
                                  met ? r->one[i].hit.primID : SAG_INVALID_ID};
        }
}

answer peer_closest(const peer *p, const sag_ray *ray) {
    struct RTCRayHit q = single_ray_hit(ray);
    closest_options options = for_closest(false);
    closest1(p->scene, &options, &q);
    return q.hit.geomID == RTC_INVALID_GEOMETRY_ID ? (answer){INFINITY, SAG_INVALID_ID}
                                                   : (answer){(double)q.ray.tfar, q.hit.primID};
}
#else
const char *peer_name(void) { return NULL; }
peer *peer_create(const model *m, int quality, bool robust, uint32_t threads, built *b) {
    (void)m, (void)quality, (void)robust, (void)threads, (void)b;
    return NULL;
}
void peer_destroy(peer *p) { (void)p; }
peer_run *peer_run_create(const peer *p, const ray_set *set, uint32_t threads, peer_call call) {
    (void)p, (void)set, (void)threads, (void)call;
    return NULL;
}
void peer_run_destroy(peer_run *r) { (void)r; }
void peer_reset(void *run) { (void)run; }
double peer_trace(void *run) {
    (void)run;
    return 0;
}
void peer_answers(const peer_run *r, answer *answers) { (void)r, (void)answers; }
answer peer_closest(const peer *p, const sag_ray *ray) {
    (void)p, (void)ray;
    return (answer){INFINITY, SAG_INVALID_ID};
}
#endif
