!> The printed listing, in the form of the paper's Rys. 5: title, data, structure, then the tables.
!> It takes finished data and depends on nothing else: two correct programs print the same bytes.
module listing
   use kinds, only: wp
   use mechanism, only: settings_t, mechanism_t, request_t
   use motion, only: mark_none, mark_not_converged, mark_singular, mark_inconsistent, singular_unclear, &
      singular_dead, diagnostic_t
   use structure, only: findings_t, group_t, spare_drives_text
   use branch_certificate, only: certificate_counts_t
   use points, only: is_listed, row_t
   use sensitivities, only: has_tolerances
   use independent, only: set_t, request_of
   use set_motion, only: set_motion_t, is_flagged, has_words, find_row_in_set, doubt_in_set, spread_in_set
   use listing_layout, only: layout_t, new_layout
   use listing_tables, only: listing_state_t, no_table, put_instant, put_requested, put_spreads
   use listing_diagnostics, only: put_diagnostics, no_position_words, put_singular, put_closure_error, remarks_text
   use text_output, only: output_t, put, add
   use numerals, only: whole
   use known_digits, only: unknown_digit
   use phrases
   implicit none
   private
   public :: layout_t, new_layout, listing_state_t, listing_head, listing_instant, listing_end, listing_broken_off, &
      words_of_mark

   !> Why there is not all of a motion, by its mark.
   type(phrase_t), parameter :: mark_words(mark_none:mark_inconsistent) = &
      [phrase_t(), say_no_position, phrase_t(), say_overflow, say_contradiction]
   !> The same of mark_singular, by what the position is.
   type(phrase_t), parameter :: singular_words(singular_unclear:singular_dead) = &
      [say_singular, say_change_point, say_dead_point]
   integer, parameter :: links_a_line = 10

contains

   !> Title, data and structure of one set.
   subroutine listing_head(o, m, findings)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: findings
      integer :: i

      associate (pl => m%polish)
         call put(o, ' KINMAT   '//phrase(say_program, pl))
         call put(o, '')
         call put(o, trim(' '//phrase(say_set, pl)//' '//whole(m%set_number) &
            //'   '//phrase(say_title, pl)//'   '//m%title))
         call put(o, '')
         call put(o, ' '//phrase(say_data, pl))
         do i = 1, size(m%echo)
            call put(o, ' '//trim(m%echo(i)))
         end do
         if (allocated(m%remarks)) call put(o, remarks_text(m))
         call put(o, '')
         call put_structure(o, m, findings)
         call put(o, '')
         call put(o, ' '//phrase(say_results, pl))
      end associate
   end subroutine listing_head

   !> Counts and groups `f` of `m`.
   subroutine put_structure(o, m, f)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: f

      associate (pl => m%polish)
         call put(o, ' '//phrase(say_structure, pl))
         call put(o, ' '//phrase(say_links, pl)//' '//whole(f%links)//', '//phrase(say_ground, pl) &
            //' '//whole(f%ground)//';  '//phrase(say_revolute, pl)//' '//whole(f%revolute) &
            //';  '//phrase(say_prismatic, pl)//' '//whole(f%prismatic))
         call put(o, ' '//phrase(say_coordinates, pl)//' W = '//whole(f%coordinates)//';  '//phrase(say_equations, pl) &
            //' R = '//whole(f%equations)//';  '//phrase(say_degrees_of_freedom, pl)//' S = ' &
            //whole(f%degrees_of_freedom)//';  '//phrase(say_drives, pl)//' '//whole(f%drives))
         if (f%degrees_of_freedom < f%drives .and. f%spare_drives == 0) call put(o, ' --- '//phrase(say_repeating, pl) &
            //' '//whole(f%drives - f%degrees_of_freedom))
         if (f%spare_drives > 0) call put(o, ' --- '//phrase(say_spare_drives, pl)//' '//spare_drives_text(m, f, pl))
      end associate
      if (allocated(f%groups)) call put_groups(o, m, f%groups)
   end subroutine put_structure

   !> A line of links for each group, continued where they are many.
   subroutine put_groups(o, m, groups)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(group_t), intent(in) :: groups(:)
      character(18) :: head
      integer :: i, k

      if (size(groups) > 0) call put(o, ' '//phrase(say_groups, m%polish))
      do i = 1, size(groups)
         head = whole(i)
         head(:6) = adjustr(head(:6))
         if (groups(i)%driven) head(9:) = phrase(say_driven, m%polish)
         if (.not. groups(i)%needed) head(9:) = phrase(say_not_needed, m%polish)
         do k = 1, size(groups(i)%links)
            if (mod(k, links_a_line) == 1) call add(o, ' '//head)
            if (k == size(groups(i)%links) .or. mod(k, links_a_line) == 0) then
               call put(o, ' '//trim(m%links(groups(i)%links(k))%name))
            else
               call add(o, ' '//m%links(groups(i)%links(k))%name)
            end if
            head = ''
         end do
      end do
   end subroutine put_groups

   !> The tables of instant number `step` (0, 1, ...) of the motions `s`, as far as the deck asks for them there;
   !> digits that rounding leaves open are masked. Then what there is to say of the instant. `table`: as the instant
   !> before has left it; after remarks the next instant has its heads again.
   subroutine listing_instant(o, l, s, step, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: step
      type(listing_state_t), intent(inout) :: table
      type(row_t) :: row
      type(request_t) :: request
      integer :: i, c
      logical :: begun

      begun = .false.
      table%masked = .false.
      do i = 1, size(s%rows)
         request = request_of(s, i)
         if (.not. is_listed(s, request, step)) cycle
         if (.not. begun) call put_instant(o, l, s%motions(1)%t, step, table)
         begun = .true.
         call find_row_in_set(s, i, row)
         associate (d => l%own(s%rows(i)%part))
            call put_requested(o, l, d, s%polish, request, row, doubt_in_set(row, s, i), table)
            if (has_tolerances(s%parts(s%rows(i)%part), request)) &
               call put_spreads(o, l, d, s%polish, request, row, spread_in_set(s, i), table)
         end associate
      end do
      if (.not. begun .and. is_flagged(s)) call put_instant(o, l, s%motions(1)%t, step, table)
      if (table%masked .or. has_words(s)) table%kind = no_table
      call put_marks(o, s)
      if (table%masked) call put(o, ' --- '//unknown_digit//': '//phrase(say_unknown, s%polish))
      do c = 1, s%count
         if (allocated(s%motions(c)%diagnostics)) call put_diagnostics(o, s%parts(c), s%motions(c)%diagnostics)
      end do
   end subroutine listing_instant

   !> Why some part of `s` has not all of its motion, each reason once, and of singular positions each with its links.
   subroutine put_marks(o, s)
      type(output_t), intent(inout) :: o
      type(set_motion_t), intent(in) :: s
      character(:), allocatable :: line, lines
      integer :: k, i, c

      lines = ''
      do c = 1, s%count
         if (s%motions(c)%mark /= mark_not_converged) cycle
         line = ' *** '//no_position_words(s%parts(c), s%motions(c)%diagnostics)//new_line('a')
         if (index(lines, line) == 0) lines = lines//line
      end do
      if (len(lines) > 0) call put(o, lines(:len(lines) - 1))
      do k = mark_singular, mark_inconsistent
         if (k /= mark_singular) then
            if (any(s%motions%mark == k)) call put(o, ' *** '//words_of_mark(k, singular_unclear, s%polish))
            cycle
         end if
         do i = singular_unclear, singular_dead
            do c = 1, s%count
               if (s%motions(c)%mark == k .and. s%motions(c)%singularity == i) call put_singular(o, s%parts(c), &
                  words_of_mark(k, i, s%polish), s%motions(c)%singular_links)
            end do
         end do
      end do
   end subroutine put_marks

   !> Why there is not all of a motion, by its `mark`, and where that is mark_singular by its `singularity`.
   pure function words_of_mark(mark, singularity, polish) result(words)
      integer, intent(in) :: mark, singularity
      logical, intent(in) :: polish
      character(:), allocatable :: words

      words = phrase(mark_words(mark), polish)
      if (mark == mark_singular) words = phrase(singular_words(singularity), polish)
   end function words_of_mark

   !> The last lines of a set: where equations are redundant, by how much they differ (`closure_error`, in parts of the
   !> characteristic length; negative where none are); `diagnostics`; what is certified of the branches on which the
   !> instants were found; how many instants were `solved` and how many are `flagged`.
   subroutine listing_end(o, s, solved, flagged, certificate_counts, closure_error, diagnostics)
      type(output_t), intent(inout) :: o
      class(set_t), intent(in) :: s
      integer, intent(in) :: solved, flagged
      type(certificate_counts_t), intent(in) :: certificate_counts
      real(wp), intent(in), optional :: closure_error
      type(diagnostic_t), intent(in), optional :: diagnostics(:)
      character(:), allocatable :: end_of
      integer :: i

      call put(o, '')
      if (present(closure_error)) then
         if (closure_error >= 0.0_wp) call put_closure_error(o, s%polish, closure_error)
      end if
      if (present(diagnostics)) then
         do i = 1, size(diagnostics)
            call put_diagnostics(o, s%parts(diagnostics(i)%part), diagnostics(i:i))
         end do
      end if
      associate (c => certificate_counts)
         call put(o, ' '//phrase(say_continuation, s%polish)//':  '//phrase(say_certified, s%polish)//' ' &
            //whole(c%followed)//' '//phrase(say_out_of, s%polish)//' '//whole(c%followed + c%uncertain) &
            //', '//phrase(say_passed, s%polish)//' '//whole(c%passed))
      end associate
      end_of = ' '//phrase(say_end, s%polish)//' '//whole(s%set_number)
      if (s%variant > 0) end_of = ' '//phrase(say_end_variant, s%polish)//' '//whole(s%variant)
      call put(o, end_of//':  '//phrase(say_solved, s%polish)//' '//whole(solved) &
         //', '//phrase(say_flagged, s%polish)//' '//whole(flagged))
      call put(o, '')
   end subroutine listing_end

   !> Puts the last line of a run that ends before its time: `words` name the kind of the last result, an instant, a
   !> variant or a set, and `number` tells which.
   subroutine listing_broken_off(o, m, words, number)
      type(output_t), intent(inout) :: o
      class(settings_t), intent(in) :: m
      type(phrase_t), intent(in) :: words
      integer, intent(in) :: number

      call put(o, '')
      call put(o, ' *** '//phrase(words, m%polish)//' '//whole(number))
   end subroutine listing_broken_off
end module listing
