// SPDX-License-Identifier: GPL-3.0-or-later
// What every room's job strip says: what runs, or how the preview stands.
import { formatCount, formatDuration, JobStrip } from '../../ui';
import type { Activity } from '../session/room_session';
import { placesText } from './work_places';

export type RunningActivity = Exclude<Activity, { kind: 'idle' }>;

export interface RunningStripProps {
  readonly activity: RunningActivity;
  readonly titles: Readonly<Record<RunningActivity['kind'], string>>;
  readonly onCancel: () => void;
}

export function RunningStrip({ activity, titles, onCancel }: RunningStripProps) {
  return (
    <JobStrip
      state="running"
      title={titles[activity.kind]}
      detail={activity.progress?.stage ?? (activity.kind === 'opening' ? activity.name : 'Starting')}
      figures={placesText(activity.progress?.places)}
      progress={activity.progress ?? { fraction: 0, seconds_left: null }}
      onCancel={onCancel}
    />
  );
}

export interface PreviewLineProps {
  /** What keeps it from being made, and its title. */
  readonly error: string | undefined;
  readonly failed: string;
  /** Title while nothing is shown. */
  readonly empty: string;
  /** Corners of triangles of what is shown, null while nothing is. */
  readonly corners: number | null;
  readonly seconds: number | null;
  readonly previewing: boolean;
}

/** "Preview up to date", "10,240 triangles, 0.4 s in the browser". */
export function previewLine({ error, failed, empty, corners, seconds, previewing }: PreviewLineProps) {
  if (error) return { state: 'attention' as const, title: failed, detail: error };
  if (corners === null) return { state: 'idle' as const, title: empty, detail: 'A preview is made first' };
  const triangles = `${formatCount(corners / 3)} triangles`;
  return {
    state: 'idle' as const,
    title: previewing ? 'Preview' : 'Preview up to date',
    detail: seconds === null ? triangles : `${triangles}, ${formatDuration(seconds)} in the browser`,
  };
}
