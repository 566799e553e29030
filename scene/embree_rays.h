// burin/scene/embree_rays.h - common interface to Embree 3 and 4, which differ in the place of a query's settings.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace burin {

#if RTC_VERSION_MAJOR >= 4
/// Settings of one query. A caller's struct may begin with it; filter functions receive it.
using QueryContext = RTCRayQueryContext;
inline void init_query(QueryContext& context) { rtcInitRayQueryContext(&context); }
#else
using QueryContext = RTCIntersectContext;
inline void init_query(QueryContext& context) { rtcInitIntersectContext(&context); }
#endif

/// First hit of one ray.
inline void first_hit(RTCScene scene, RTCRayHit& query) {
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect1(scene, &query);
#else
  QueryContext context;
  init_query(context);
  rtcIntersect1(scene, &context, &query);
#endif
}

/// Tests a ray for any hit: it sets `ray.tfar` below 0. Filter functions receive `context`. `coherent`: the next ray is
/// similar.
inline void any_hit(RTCScene scene, QueryContext& context, bool coherent, RTCRay& ray) {
#if RTC_VERSION_MAJOR >= 4
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.context = &context;
  if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcOccluded1(scene, &ray, &arguments);
#else
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcOccluded1(scene, &context, &ray);
#endif
}

}  // namespace burin
