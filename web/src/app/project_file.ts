// SPDX-License-Identifier: GPL-3.0-or-later
import { download, safeFileName } from '../shared/session/download';
import { projectExtension } from '../project/archive';
import type { ProjectStore } from '../project/project_store';
import { toast } from '../ui';

export async function saveAsFile(projects: ProjectStore): Promise<void> {
  const { name } = projects.document.value;
  const bytes = await projects.exportFile();
  download(bytes, `${safeFileName(name)}.${projectExtension}`, 'application/zip');
  toast('Project saved as a file.');
}
