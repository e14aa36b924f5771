-- How many trials there are, and of how many worlds a point may show its trials if there are to be ?1 of them at most.
WITH counted AS (
  SELECT world_index, count(*) AS n FROM point_trial GROUP BY world_index
), summed AS (
  SELECT world_index, n, sum(n) OVER (ORDER BY world_index) AS up_to FROM counted
)
SELECT coalesce(sum(n), 0) AS trials, coalesce(max(world_index + 1) FILTER (WHERE up_to <= ?1), 1) AS worlds
FROM summed
