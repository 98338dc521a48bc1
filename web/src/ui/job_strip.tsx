// SPDX-License-Identifier: GPL-3.0-or-later
import type { ComponentChildren } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import { Button } from './button';
import type { IconName } from './icon';
import { Icon } from './icon';
import { formatDuration } from './numbers';

export interface JobStripProps {
  readonly state: 'idle' | 'running' | 'done' | 'attention';
  readonly title: string;
  readonly detail: string;
  /** Beside the detail; not announced, since it changes all the time. */
  readonly figures?: string | undefined;
  readonly progress?: { readonly fraction: number; readonly seconds_left: number | null } | null;
  readonly onCancel?: (() => void) | undefined;
  /** Earlier results. */
  readonly children?: ComponentChildren;
}

const icons: Record<JobStripProps['state'], IconName> = {
  idle: 'clock',
  running: 'clock',
  done: 'check',
  attention: 'warn',
};

/** Left, what runs or ran; right, earlier results. Stages are announced one by one, not every percent. */
export function JobStrip({ state, title, detail, figures, progress, onCancel, children }: JobStripProps) {
  const percent = Math.round(100 * (progress?.fraction ?? 0));
  return (
    <div class="job">
      <span class={`job-state ${state}`}>
        <Icon name={icons[state]} />
      </span>
      <span class="hidden-text" role="status">
        {state === 'idle' ? title : `${title}. ${detail}`}
      </span>
      <div class="job-text">
        <strong>{title}</strong>
        <span class="clip">{figures ? `${detail} · ${figures}` : detail}</span>
      </div>
      {progress ? (
        <>
          <div
            class="progress"
            role="progressbar"
            aria-label={title}
            aria-valuenow={percent}
            aria-valuemin={0}
            aria-valuemax={100}
          >
            <i style={{ width: `${percent}%` }} />
          </div>
          <span class="job-figures">
            {percent} %
            {progress.seconds_left !== null ? (
              <span>{formatDuration(progress.seconds_left)} left</span>
            ) : null}
          </span>
          {onCancel ? (
            <Button size="small" onClick={onCancel}>
              Cancel <kbd>Esc</kbd>
            </Button>
          ) : null}
        </>
      ) : (
        children
      )}
    </div>
  );
}

/** True once `active` has lasted `delay_ms`: what is over sooner shows nothing. */
export function useLasting(active: boolean, delay_ms = 300): boolean {
  const [lasting, setLasting] = useState(false);
  const timer = useRef<ReturnType<typeof setTimeout> | undefined>(undefined);
  useEffect(() => {
    if (active) timer.current = setTimeout(() => setLasting(true), delay_ms);
    else setLasting(false);
    return () => clearTimeout(timer.current);
  }, [active]);
  return active && lasting;
}
