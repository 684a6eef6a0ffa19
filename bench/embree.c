// SPDX-License-Identifier: MIT
// Embree 3 or 4 on the same triangles and rays, robust mode, one thread a call, single precision.
#include "model.h"

#ifdef BENCH_EMBREE
#include <stdlib.h>
#include <string.h>
#if BENCH_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

struct peer {
    RTCDevice device;
    RTCScene scene;
};

#define TEXT_OF(x) #x
#define TEXT(x)    TEXT_OF(x)
const char *peer_name(void) {
    return "Embree " TEXT(RTC_VERSION_MAJOR) "." TEXT(RTC_VERSION_MINOR) " (float, robust)";
}

peer *peer_create(const model *m, double *build_seconds) {
    peer *p = malloc(sizeof *p);
    if (p == NULL) return NULL;
    p->device = rtcNewDevice(NULL);
    p->scene = rtcNewScene(p->device);
    rtcSetSceneFlags(p->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry g = rtcNewGeometry(p->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void *v = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, m->vertex_count);
    memcpy(v, m->positions, (size_t)m->vertex_count * 12);
    void *t = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, m->triangle_count);
    memcpy(t, m->triangles, (size_t)m->triangle_count * 12);
    rtcCommitGeometry(g);
    rtcAttachGeometry(p->scene, g);
    rtcReleaseGeometry(g);
    double start = seconds_now();
    rtcCommitScene(p->scene);
    *build_seconds = seconds_now() - start;
    return p;
}

void peer_destroy(peer *p) {
    rtcReleaseScene(p->scene);
    rtcReleaseDevice(p->device);
    free(p);
}

double peer_trace(peer *p, const sag_ray *rays, float *t, size_t count, bool occluded) {
#if BENCH_EMBREE == 3
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
#endif
    double start = seconds_now();
    for (size_t i = 0; i < count; i++) {
        const sag_ray *r = &rays[i];
        struct RTCRayHit q = {.ray = {.org_x = (float)r->origin.x,
                                      .org_y = (float)r->origin.y,
                                      .org_z = (float)r->origin.z,
                                      .dir_x = (float)r->direction.x,
                                      .dir_y = (float)r->direction.y,
                                      .dir_z = (float)r->direction.z,
                                      .tnear = (float)r->t_min,
                                      .tfar = (float)r->t_max,
                                      .mask = 0xFFFFFFFFu},
                              .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
#if BENCH_EMBREE == 3
        if (occluded)
            rtcOccluded1(p->scene, &context, &q.ray);
        else
            rtcIntersect1(p->scene, &context, &q);
#else
        if (occluded)
            rtcOccluded1(p->scene, &q.ray, NULL);
        else
            rtcIntersect1(p->scene, &q, NULL);
#endif
        t[i] = occluded ? (q.ray.tfar < 0 ? 0 : INFINITY)
                        : (q.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITY : q.ray.tfar);
    }
    return seconds_now() - start;
}
#else
const char *peer_name(void) { return NULL; }
peer *peer_create(const model *m, double *build_seconds) {
    (void)m, (void)build_seconds;
    return NULL;
}
void peer_destroy(peer *p) { (void)p; }
double peer_trace(peer *p, const sag_ray *rays, float *t, size_t count, bool occluded) {
    (void)p, (void)rays, (void)t, (void)count, (void)occluded;
    return 0;
}
#endif
