// SPDX-License-Identifier: MIT
// Models in other formats than pbrt's: PLY by our own reader, the rest through Assimp's C interface. Assimp
// is asked to cut polygons into triangles (and for normals, for pictures), so that primitives stay in the
// file's order and nothing is dropped or moved; vertices that are the same are joined here, those that are
// near are not. A mesh that several nodes show becomes one object and its instances.
#include "formats/import_file.h"
#include "formats/import_material.h"

#include "formats/image.h"
#include "formats/output.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#define MAX_NODE_DEPTH 1024

typedef struct importer {
    sag_world *world;
    const sag_context *context;
    const sagi_load_options *options;
    const char *path;
    char directory[SAGI_MAX_PATH];
    sag_error *error;
    const struct aiScene *scene;
    sag_affine upright;    // turns the file's up to y
    uint32_t *uses;        // how many nodes show each mesh
    sag_scene **objects;   // of each mesh shown more than once
    sag_appearance *looks; // of each material
    sag_box3 *bounds;      // of all that stands in the world; or NULL
    uint64_t triangle_count;
} importer;

static sag_status out_of_memory(const importer *m) {
    return sag_error_set_at(m->error, SAG_ERROR_MEMORY, m->path, 0, 0, "out of memory loading the model");
}

// ---- meshes

static bool copy_mesh(const struct aiMesh *from, sagi_mesh_data *data, const sag_context *context) {
    const size_t n = from->mNumVertices;
    *data = (sagi_mesh_data){.context = context, .vertex_count = from->mNumVertices};
    data->positions_f32 = sag_allocate(context, 3 * n * sizeof(float));
    if (from->mNormals) data->normals = sag_allocate(context, 3 * n * sizeof(float));
    if (from->mTextureCoords[0]) data->texcoords = sag_allocate(context, 2 * n * sizeof(float));
    if (!data->positions_f32 || (from->mNormals && !data->normals) ||
        (from->mTextureCoords[0] && !data->texcoords))
        return false;
    for (size_t i = 0; i < n; i++) {
        const struct aiVector3D p = from->mVertices[i];
        data->positions_f32[3 * i] = p.x, data->positions_f32[3 * i + 1] = p.y,
                                data->positions_f32[3 * i + 2] = p.z;
        if (from->mNormals) {
            const struct aiVector3D q = from->mNormals[i];
            data->normals[3 * i] = q.x, data->normals[3 * i + 1] = q.y, data->normals[3 * i + 2] = q.z;
        }
        if (from->mTextureCoords[0]) {
            const struct aiVector3D q = from->mTextureCoords[0][i];
            data->texcoords[2 * i] = q.x, data->texcoords[2 * i + 1] = q.y;
        }
    }
    for (size_t i = 0; i < from->mNumFaces; i++) {
        const struct aiFace *face = &from->mFaces[i];
        if (face->mNumIndices == 3 &&
            !sagi_mesh_data_add(data, face->mIndices[0], face->mIndices[1], face->mIndices[2]))
            return false;
    }
    return sagi_mesh_data_join(data);
}

// Adds mesh number i to a scene, placed by the map.
static sag_status add_mesh(importer *m, unsigned i, sag_scene *scene, const sag_affine *placed) {
    const struct aiMesh *from = m->scene->mMeshes[i];
    if (from->mNumVertices == 0 || from->mNumFaces == 0) return SAG_OK;
    sagi_mesh_data data;
    if (!copy_mesh(from, &data, m->context)) {
        sagi_mesh_data_clear(&data);
        return out_of_memory(m);
    }
    sag_status status = SAG_OK;
    if (data.triangle_count > 0) {
        m->triangle_count += data.triangle_count;
        sag_appearance look = {0};
        if (!m->options->geometry_only) {
            look = m->looks[from->mMaterialIndex];
        }
        status = sagi_import_add(m->world, m->options, scene, &data,
                                 from->mName.length ? from->mName.data : m->path, &look, placed,
                                 scene == sag_world_scene(m->world) ? m->bounds : NULL, m->error);
    }
    sagi_mesh_data_clear(&data);
    return status;
}

static sag_affine affine_of(const struct aiMatrix4x4 *a) {
    const sag_affine r = {{{(double)a->a1, (double)a->a2, (double)a->a3, (double)a->a4},
                           {(double)a->b1, (double)a->b2, (double)a->b3, (double)a->b4},
                           {(double)a->c1, (double)a->c2, (double)a->c3, (double)a->c4}}};
    return r;
}

// Shows mesh i once more: as itself, or as an instance when several nodes show it.
static sag_status show_mesh(importer *m, unsigned i, const sag_affine *placed) {
    sag_scene *world_scene = sag_world_scene(m->world);
    if (m->uses[i] == 1) return add_mesh(m, i, world_scene, placed);
    if (!m->objects[i]) {
        m->objects[i] = sag_world_add_object(m->world);
        if (!m->objects[i]) return out_of_memory(m);
        const sag_affine identity = sag_affine_identity();
        sag_status status = add_mesh(m, i, m->objects[i], &identity);
        if (status == SAG_OK) status = sag_scene_commit(m->objects[i], m->error);
        if (status != SAG_OK) return status;
    }
    if (m->bounds) {
        const sag_box3 own = sag_scene_bounds(m->objects[i]);
        if (!sag_box3_is_empty(&own)) *m->bounds = sag_box3_union(*m->bounds, sag_affine_box(placed, &own));
    }
    return sag_add_instance(world_scene, m->objects[i], placed) != SAG_INVALID_ID ? SAG_OK : out_of_memory(m);
}

// Visits all nodes, parents first, with a stack of its own: how deep a file nests its nodes is its affair.
typedef struct visit {
    const struct aiNode *node;
    unsigned next_child;
    sag_affine to_world;
} visit;

static sag_status walk(importer *m, bool counting) {
    visit *stack = sag_allocate(m->context, MAX_NODE_DEPTH * sizeof *stack);
    if (!stack) return out_of_memory(m);
    int depth = 0;
    sag_status status = SAG_OK;
    stack[depth++] = (visit){m->scene->mRootNode, 0, m->upright};
    for (bool arrived = true; depth > 0 && status == SAG_OK;) {
        visit *v = &stack[depth - 1];
        if (arrived) {
            const sag_affine here = affine_of(&v->node->mTransformation);
            v->to_world = sag_affine_multiply(&v->to_world, &here);
            for (unsigned k = 0; k < v->node->mNumMeshes && status == SAG_OK; k++) {
                const unsigned i = v->node->mMeshes[k];
                if (counting)
                    m->uses[i]++;
                else
                    status = show_mesh(m, i, &v->to_world);
            }
        }
        arrived = v->next_child < v->node->mNumChildren;
        if (!arrived) {
            depth--;
        } else if (depth == MAX_NODE_DEPTH) {
            status = sag_error_set_at(m->error, SAG_ERROR_FORMAT, m->path, 0, 0,
                                      "nodes nest more than %d deep", MAX_NODE_DEPTH);
        } else {
            // Some of Assimp's readers (RAW) count children that they do not make.
            const struct aiNode *child = v->node->mChildren[v->next_child++];
            arrived = child != NULL;
            if (child) stack[depth++] = (visit){child, 0, v->to_world};
        }
    }
    sag_release(m->context, stack, MAX_NODE_DEPTH * sizeof *stack);
    return status;
}

static sag_status import_scene(importer *m) {
    const unsigned meshes = m->scene->mNumMeshes, materials = m->scene->mNumMaterials;
    if (meshes == 0 || !m->scene->mRootNode)
        return sag_error_set_at(m->error, SAG_ERROR_FORMAT, m->path, 0, 0, "there are no triangles in it");
    const size_t sizes[3] = {meshes * sizeof *m->uses, meshes * sizeof *m->objects,
                             (materials ? materials : 1) * sizeof *m->looks};
    m->uses = sag_allocate(m->context, sizes[0]);
    m->objects = sag_allocate(m->context, sizes[1]);
    m->looks = sag_allocate(m->context, sizes[2]);
    sag_status status = out_of_memory(m);
    if (m->uses && m->objects && m->looks) {
        memset(m->uses, 0, sizes[0]);
        memset(m->objects, 0, sizes[1]);
        memset(m->looks, 0, sizes[2]);
        const sagi_import_source source = {m->world, m->scene, m->path, m->directory};
        bool made = true;
        for (unsigned i = 0; i < materials && !m->options->geometry_only && made; i++)
            made = sagi_import_look(&source, m->scene->mMaterials[i], &m->looks[i]);
        if (made) status = walk(m, true);
        if (status == SAG_OK) status = walk(m, false);
        if (status == SAG_OK && m->triangle_count == 0)
            status =
                sag_error_set_at(m->error, SAG_ERROR_FORMAT, m->path, 0, 0, "there are no triangles in it");
    }
    sag_release(m->context, m->uses, sizes[0]);
    sag_release(m->context, m->objects, sizes[1]);
    sag_release(m->context, m->looks, sizes[2]);
    return status;
}

// A face without corners counts as a polygon when Assimp looks what there is; and having found no polygon to
// cut after all, it ends the program. So it is told what there is.
static void name_primitives(const struct aiScene *scene) {
    for (unsigned i = 0; i < scene->mNumMeshes; i++) {
        struct aiMesh *mesh = scene->mMeshes[i];
        bool polygons = false;
        for (unsigned k = 0; k < mesh->mNumFaces && !polygons; k++)
            polygons = mesh->mFaces[k].mNumIndices > 3;
        if (polygons) continue;
        mesh->mPrimitiveTypes &= ~(unsigned)aiPrimitiveType_POLYGON;
        mesh->mPrimitiveTypes |= aiPrimitiveType_TRIANGLE; // none at all would count as unknown
    }
}

// Assimp is not asked to join vertices: it takes for the same what is nearer than some absolute distance, and
// a small model is a single point. For pictures, what brings no normals of its own gets smooth ones that stop
// at creases: where neighbouring faces turn by more than 40 degrees.
static const struct aiScene *import_file(const importer *m) {
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    if (!properties) return NULL;
    struct aiFileIO files = sagi_import_files(m->context);
    aiSetImportPropertyFloat(properties, AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, 40);
    const struct aiScene *scene = aiImportFileExWithProperties(m->path, 0, &files, properties);
    aiReleasePropertyStore(properties);
    if (!scene) return NULL;
    name_primitives(scene);
    const unsigned flags = aiProcess_Triangulate;
    return aiApplyPostProcessing(scene,
                                 m->options->geometry_only ? flags : flags | aiProcess_GenSmoothNormals);
}

sag_status sagi_assimp_load(sag_world *world, const char *path, const sagi_load_options *options,
                            const sag_affine *upright, sag_box3 *bounds, sag_error *error) {
    importer m = {.world = world,
                  .context = sag_world_context(world),
                  .options = options,
                  .path = path,
                  .error = error,
                  .upright = *upright,
                  .bounds = bounds};
    const char *slash = strrchr(path, '/');
    snprintf(m.directory, sizeof m.directory, "%.*s", slash ? (int)(slash - path) + 1 : 0, path);
    sag_status status = sagi_import_check(m.context, path, error);
    if (status != SAG_OK) return status;
    m.scene = import_file(&m);
    if (!m.scene) {
        const char *reason = aiGetErrorString();
        return sag_error_set_at(error, SAG_ERROR_FORMAT, path, 0, 0, "cannot read: %.400s",
                                reason && reason[0] ? reason : "unknown reason");
    }
    status = import_scene(&m);
    aiReleaseImport(m.scene);
    return status;
}
