// burin/scene/embree_rays.h - Embree 3 and 4 under one name: the two differ in where a query's settings stand.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace burin {

#if RTC_VERSION_MAJOR >= 4
/// Settings of one query; a struct of one's own may begin with it (filter functions get it back).
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

/// Whether anything lies on a ray: `ray.tfar` is below 0 then. Filter functions are given `context`; `coherent`: the
/// next ray runs alike.
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
