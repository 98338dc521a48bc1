// SPDX-License-Identifier: GPL-3.0-or-later
// The tutorials to choose from, on the start page and in Help.
import type { ProjectStore } from '../../project/project_store';
import { Dialog, Icon } from '../../ui';
import { toastFailure } from '../failure_toast';
import './learn.css';
import { startTutorial } from './learning';
import { tutorials } from './tutorials';

interface LearnListProps {
  readonly projects: ProjectStore;
  readonly onStart?: () => void;
}

export function LearnList({ projects, onStart }: LearnListProps) {
  return (
    <ul class="learn-list">
      {tutorials.map((tutorial) => (
        <li key={tutorial.name}>
          <button
            type="button"
            onClick={() => {
              onStart?.();
              toastFailure(startTutorial(tutorial, projects));
            }}
          >
            <Icon name="play" />
            <span>
              <strong>{tutorial.title}</strong>
              <span>{tutorial.makes}</span>
            </span>
          </button>
        </li>
      ))}
    </ul>
  );
}

export function LearnDialog({ projects, onClose }: { projects: ProjectStore; onClose: () => void }) {
  return (
    <Dialog title="Learn" onClose={onClose}>
      <p>
        Each tutorial takes about ten minutes and guides you through the page itself. It begins a new project;
        yours is saved first.
      </p>
      <LearnList projects={projects} onStart={onClose} />
    </Dialog>
  );
}
