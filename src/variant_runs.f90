!> The variants of a set with VARY cards. Each is made when its turn comes, starts from the deck's own estimate and
!> leaves a row. Its row does not depend on the other variants, and memory does not grow with their number. If only rows
!> are asked for, several variants are solved together. The row of a variant that cannot be computed tells why.
module variant_runs
   use failures, only: status_flagged
   use mechanism, only: settings_t, mechanism_t, request_t
   use independent, only: set_t
   use set_members, only: requests_of, has_cylinders
   use structure, only: structure_report_t, find_structure, faults_text
   use deck, only: build_variant
   use deck_variants, only: variation_t
   use command_line, only: out_listing, out_csv, out_log, out_summary
   use outputs, only: outputs_t, is_over
   use job_chunks, only: write_in_turn
   use writers, only: writers_t, break_off
   use motion_run, only: run_motion
   use listing, only: layout_t, new_layout
   use solver_log, only: log_head
   use answers, only: answers_t
   use variant_rows, only: summary_t, variant_row_t, new_summary, new_row, fill_row
   use variant_tables, only: summary_head, summary_row, write_variant, write_variant_heads, write_variant_row, &
      write_variants_end
   use lane_runs, only: lane_run_t, begin_run, run_lanes, lane_count
   use lane_state, only: lanes_t
   use phrases, only: text_broken_variant
   use set_motion, only: new_set_motion
   use set_analysis, only: set_analysis_t, analyze_set, reuse_set_analysis
   use kinds, only: wp
   implicit none
   private
   public :: run_variants, are_together

contains

   !> Solves and writes variants of a set. After a signal or a failed output no further variant is solved, and the last
   !> line of the listing tells so.
   subroutine run_variants(set, first, last, variation, writers)
      class(set_t), intent(in) :: set        !< with the numbers of the deck
      integer, intent(in) :: first, last     !< numbers of the first and the last variant, from 1
      type(variation_t), intent(inout) :: variation   !< of the set
      type(writers_t), intent(inout) :: writers   !< open; get the text of the variants
      type(layout_t) :: layout
      type(summary_t) :: summary
      type(variant_row_t) :: row
      type(mechanism_t) :: variant
      type(request_t), allocatable :: requests(:)
      logical :: full, has_more              ! full: the listing has tables; has_more: ratios or cylinders
      integer :: n                           ! the first variant that is not written

      n = first
      requests = requests_of(set)
      full = any(requests%every > 0)
      has_more = any(requests%drive > 0) .or. has_cylinders(set)
      layout = new_layout(set)
      summary = new_summary(set, layout, variation)
      if (writers%asked(out_summary) .and. first == 1) call summary_head(writers%files(out_summary), summary)
      if (writers%asked(out_listing) .and. first == 1 .and. .not. full) then
         call write_variant_heads(writers%files(out_listing), summary)
      end if

      if (are_together(set, full .or. has_more, writers)) then
         call run_together()
      else
         do while (n <= last)
            row = new_row(summary, variation, n)
            if (writers%asked(out_listing) .and. full) call write_variant(writers%files(out_listing), layout, summary, &
               set, row)
            call run_variant(variant, row)
            if (is_over(writers)) exit
            if (writers%asked(out_listing) .and. full) call write_variant_heads(writers%files(out_listing), summary)
            call write_row(row)
            n = n + 1
         end do
      end if
      if (n <= last) call break_off(writers, set, text_broken_variant, n - 1)
      if (n > variation%total .and. writers%asked(out_listing)) call write_variants_end(writers%files(out_listing), set)

   contains

      !> Solves the variants `n` to `last`, as many at a time as there are lanes, and writes their rows. Afterwards `n`
      !> is the first variant that is not written.
      subroutine run_together()
         ! Of a class, so that the compiler calls what makes and frees one, and does not write it out for each use.
         class(lane_run_t), allocatable :: runs(:)
         type(variant_row_t) :: rows(lane_count)
         type(lanes_t) :: lanes
         integer :: k, count

         allocate (lane_run_t :: runs(lane_count))
         do while (n <= last)
            count = min(lane_count, last - n + 1)
            do k = 1, count
               rows(k) = new_row(summary, variation, n + k - 1)
               call prepare_variant(variation, runs(k), rows(k))
            end do
            call run_lanes(runs(:count), lanes)

            do k = 1, count
               if (is_over(writers)) return
               if (rows(k)%rejected == '') then
                  rows(k)%counts_t = runs(k)%counts
                  call fill_row(summary, runs(k)%s%now, runs(k)%asked, rows(k))
               else
                  call fill_row(summary, set, runs(k)%asked, rows(k))
               end if
               call write_row(rows(k))
               n = n + 1
            end do
         end do
      end subroutine run_together

      !> Makes the variant of a row, solves it and fills the row. If the variant is rejected, the row has the reason.
      subroutine run_variant(variant, row)
         type(mechanism_t), intent(inout) :: variant   !< becomes the variant
         type(variant_row_t), intent(inout) :: row   !< with its number; gets the results
         type(structure_report_t) :: structure_report
         type(set_analysis_t) :: a
         type(answers_t) :: asked

         call build_variant(variation, row%number, variant, row%rejected)
         if (row%rejected == '') call check_variant(variant, structure_report, row)
         if (row%rejected == '') then
            call new_set_motion(variant, a%now, structure_report)
            if (full .and. writers%asked(out_listing)) writers%layout = new_layout(a%now)
            if (writers%asked(out_log)) call log_head(writers%files(out_log), variant)
            call run_motion(a, structure_report, full, writers, row, asked)
            call fill_row(summary, a%now, asked, row)
         else
            call fill_row(summary, set, asked, row)
         end if
      end subroutine run_variant

      !> Writes the row of a variant.
      subroutine write_row(row)
         type(variant_row_t), intent(in) :: row   !< filled

         if (writers%asked(out_summary)) call summary_row(writers%files(out_summary), summary, set, row)
         if (writers%asked(out_listing)) call write_variant_row(writers%files(out_listing), layout, summary, set, row)
         call write_in_turn(writers)
         if (row%flagged + row%unproved > 0 .or. row%rejected /= '') writers%status = status_flagged
      end subroutine write_row
   end subroutine run_variants

   !> Makes the variant of a row ready for the lanes. A variant that is rejected is over, and its row has the reason.
   subroutine prepare_variant(variation, run, row)
      type(variation_t), intent(inout) :: variation   !< of the set
      type(lane_run_t), intent(inout) :: run   !< new, or of an earlier variant, whose structure may be used again
      type(variant_row_t), intent(inout) :: row   !< with its number; gets the reason if the variant is rejected
      type(structure_report_t) :: structure_report
      logical :: is_done

      call build_variant(variation, row%number, run%m, row%rejected)
      run%is_over = row%rejected /= ''
      if (run%is_over) return
      ! A variant with the structure of the previous variant takes over its analysis.
      call reuse_set_analysis(run%m, run%s, is_done)
      if (.not. is_done) then
         call check_variant(run%m, structure_report, row)
         run%is_over = row%rejected /= ''
         if (run%is_over) return
         call analyze_set(run%m, structure_report, run%s)
      end if
      call begin_run(run)
   end subroutine prepare_variant

   !> Finds the structure of a variant. If a check fails, the row of the variant has the first line of its sentence.
   subroutine check_variant(variant, structure_report, row)
      type(mechanism_t), intent(in) :: variant   !< of the set
      type(structure_report_t), intent(out) :: structure_report   !< of the variant
      type(variant_row_t), intent(inout) :: row   !< of the variant
      character(:), allocatable :: faults

      structure_report = find_structure(variant)
      faults = faults_text(variant, structure_report, variant%set_number)
      row%rejected = faults(:index(faults//new_line('a'), new_line('a')) - 1)
   end subroutine check_variant

   !> Tells whether the variants of a set are solved together, as many as there are lanes: only rows are asked for.
   pure logical function are_together(settings, not_have, outputs)
      class(settings_t), intent(in) :: settings   !< of the set
      logical, intent(in) :: not_have        !< the set has tables, ratios or cylinders, which lanes do not have
      class(outputs_t), intent(in) :: outputs   !< of the job

      are_together = settings%variants > 0 .and. &
         .not. (not_have .or. settings%proves .or. settings%closing > 0.0_wp .or. &
         outputs%asked(out_csv) .or. outputs%asked(out_log))
   end function are_together
end module variant_runs
