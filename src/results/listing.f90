!> The printed listing, in the form of the paper's Rys. 5: title, data, structure, then the tables.
!> The listing takes finished data and depends on nothing else: two correct programs print equal bytes.
!>
!> Diagnostics in words: three stars before a diagnostic that concerns the results, three dashes before other remarks.
module listing
   use kinds, only: wp, label_length
   use plane_vectors, only: degree
   use mechanism, only: settings_t, mechanism_t, remark_t, remark_title_long, remark_rest, remark_turns, remark_more
   use names, only: drive_length, listed, more
   use motion
   use structure, only: structure_report_t
   use continuation, only: certificate_counts_t
   use independent, only: set_t
   use set_members, only: link_names, name_in, name_of_drive
   use set_motion, only: set_motion_t, is_flagged
   use columns, only: table_of
   use points, only: row_t
   use rows, only: finished_row_t, word_worst, word_rss
   use listing_layout, only: layout_t, new_layout, write_folded, angle_unit, choose_time_digits
   use table, only: format_t, unit_of, number_text
   use listing_tables, only: listing_state_t, no_table, lines_a_head, write_times, write_heads, write_row, mask_words
   use text_output, only: output_t, put, add
   use number_format, only: whole, rounded
   use phrases
   implicit none
   private
   public :: layout_t, new_layout, listing_state_t, listing_head, listing_instant, listing_end, write_waiting
   public :: words_of_flag, at_limit, full_turn_words, measure, value_digits, write_diagnostics, remark_text

   !> The reason why a motion is not complete, by its flag.
   type(phrase_t), parameter :: flag_words(flag_none:flag_stroke) = &
      [phrase_t(), text_no_position, phrase_t(), text_overflow, text_contradiction, text_out_of_stroke]
   !> The reason for flag_singular, by the kind of the position.
   type(phrase_t), parameter :: singular_words(singular_unclear:singular_dead) = &
      [text_singular, text_change_point, text_dead_point]
   !> Links of a group in one line.
   integer, parameter :: links_a_line = 10
   !> Digits of the value of a drive at a limit, or as many as a coarser real has.
   integer, parameter :: value_digits = merge(10, 6, precision(1.0_wp) >= 10)
   !> Digits of a closure error or an angle that is off.
   integer, parameter :: error_digits = 3
   !> The diagnostics that concern the results.
   integer, parameter :: of_results(*) = [diagnostic_inconsistent, diagnostic_limit, diagnostic_stroke, &
      diagnostic_mobile, diagnostic_long, diagnostic_close, diagnostic_unused, diagnostic_dead_end]
   !> A closure error below this, in parts of the characteristic length, is rounding: no two computers have the same.
   real(wp), parameter :: min_closure_error = max(1.0e-13_wp, 400.0_wp*epsilon(1.0_wp))

   !> The words of remarks, by their kind.
   type(phrase_t), parameter :: remark_words(remark_title_long:remark_more) = &
      [text_title_long, text_title_letters, text_touching, text_link_unused, text_point_unused, &
      text_radians, text_jumps, text_open, text_drawn_stroke, text_alpha, text_rests, text_fast, text_more]

contains

   !> Writes title, data, remarks and structure of a set.
   subroutine listing_head(o, m, structure_report)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m     !< the set, with its cards
      type(structure_report_t), intent(in) :: structure_report   !< of the set, with its groups
      character(18) :: head
      integer :: i, k

      associate (pl => m%polish, f => structure_report)
         call put(o, ' KINMAT   '//phrase(text_program, pl))
         call put(o, '')
         call put(o, trim(' '//phrase(text_set, pl)//' '//whole(m%set_number) &
            //'   '//phrase(text_title, pl)//'   '//m%title))
         call put(o, '')
         call put(o, ' '//phrase(text_data, pl))
         do i = 1, size(m%echo)
            call put(o, ' '//trim(m%echo(i)))
         end do
         if (allocated(m%remarks)) then
            do i = 1, size(m%remarks)
               call write_folded(o, ' --- ', remark_text(m, m%remarks(i)))
            end do
         end if
         call put(o, '')

         call put(o, ' '//phrase(text_structure, pl))
         call put(o, ' '//phrase(text_links, pl)//' '//whole(f%links)//', '//phrase(text_ground, pl) &
            //' '//whole(f%ground)//';  '//phrase(text_revolute, pl)//' '//whole(f%revolute) &
            //';  '//phrase(text_prismatic, pl)//' '//whole(f%prismatic))
         call put(o, ' '//phrase(text_coordinates, pl)//' W = '//whole(f%coordinates) &
            //';  '//phrase(text_equations, pl)//' R = '//whole(f%equations) &
            //';  '//phrase(text_degrees_of_freedom, pl)//' S = ' &
            //whole(f%degrees_of_freedom)//';  '//phrase(text_drives, pl)//' '//whole(f%drives))
         if (f%degrees_of_freedom < f%drives) call put(o, ' --- '//phrase(text_repeating, pl)//' ' &
            //whole(f%drives - f%degrees_of_freedom))

         ! A line of links for each group, continued if they are many.
         if (size(f%groups) > 0) call put(o, ' '//phrase(text_groups, pl))
         do i = 1, size(f%groups)
            head = whole(i)
            head(:6) = adjustr(head(:6))
            if (f%groups(i)%driven) head(9:) = phrase(text_driven, pl)
            associate (links => f%groups(i)%links)
               do k = 1, size(links)
                  if (mod(k, links_a_line) == 1) call add(o, ' '//head)
                  if (k == size(links) .or. mod(k, links_a_line) == 0) then
                     call put(o, ' '//trim(m%links(links(k))%name))
                  else
                     call add(o, ' '//m%links(links(k))%name)
                  end if
                  head = ''
               end do
            end associate
         end do

         call put(o, '')
         call put(o, ' '//phrase(text_results, pl))
      end associate
   end subroutine listing_head

   !> Writes the tables of an instant, with the rows that are listed; uncertain digits are masked. Marks and
   !> diagnostics of the instant follow. After these the next instant has its heads again. Beyond a limit of motion
   !> that the instant before has explained, a part has no words and no rows without values. Instants that have nothing
   !> else wait in `table` for one line.
   subroutine listing_instant(o, l, motions, rows, step, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(set_motion_t), intent(in) :: motions   !< at the instant
      type(finished_row_t), intent(in) :: rows(:)   !< (requests of the set) at the instant
      integer, intent(in) :: step            !< the number of the instant, from 0
      type(listing_state_t), intent(inout) :: table   !< as the instant before has left it
      type(row_t) :: other
      real(wp) :: limits(motions%count)
      logical :: begun, is_explained(motions%count), has_news
      integer :: i, c, k

      limits = [(limit_before(motions%motions(c)), c=1, motions%count)]
      is_explained = .false.
      if (allocated(table%limits)) is_explained = limits < huge(1.0_wp) .and. .not. abs(limits - table%limits) > 0.0_wp
      has_news = any([((motions%motions(c)%flag /= flag_none .or. allocated(motions%motions(c)%diagnostics)) .and. &
         .not. is_explained(c), c=1, motions%count)])
      table%limits = limits
      begun = .false.
      table%masked = .false.

      do i = 1, size(rows)
         associate (row => rows(i), d => l%own(rows(i)%part))
            if (.not. row%listed) cycle
            if (is_explained(row%part) .and. row%known < 0) cycle
            if (.not. begun) call begin_instant()
            call write_heads(o, l, row%part, table_of(row%kind, row%form, l%links_table), table)
            call write_row(o, l, d, row, row%shown, row%doubt, 0, table)
            if (.not. allocated(row%others)) cycle
            ! The effect of tolerances, with more decimals: the worst case, and the root of the sum of squares.
            do k = 1, size(row%others)
               if (all(row%others(k)%word /= [character(5) :: word_worst, word_rss])) cycle
               other = row%others(k)%row
               other%name = ' '//word_rss
               if (row%others(k)%word == word_worst) other%name = ' '//phrase(text_worst, motions%polish)
               call write_row(o, l, d, other, row%shown, row%others(k)%doubt, l%more_decimals, table)
            end do
         end associate
      end do

      if (.not. begun .and. any(is_explained) .and. .not. has_news) then
         if (table%first < 0) table%first = step
         table%last = step
         return
      end if
      if (.not. begun .and. is_flagged(motions)) call begin_instant()
      if (table%masked .or. has_news) table%kind = no_table
      call write_marks()
      if (table%masked) call put(o, mask_words(motions))
      do c = 1, motions%count
         if (allocated(motions%motions(c)%diagnostics)) &
            call write_diagnostics(o, motions, motions%motions(c)%diagnostics)
      end do

   contains

      !> Writes the line over the tables, after the line of the instants before it without values.
      subroutine begin_instant()
         call write_waiting(o, motions%polish, table)
         if (any(limits < huge(1.0_wp) .and. .not. is_explained)) table%explained = step
         ! Heads that are far above do not hold any more.
         if (table%lines >= lines_a_head) table%kind = no_table
         call write_times(o, l, l%before_instant//whole(step), [motions%motions(1)%t], table)
         begun = .true.
      end subroutine begin_instant

      !> Writes why the motion of some part is not complete, each line once: with the time of a limit of motion before
      !> it, or the links of a singular position.
      subroutine write_marks()
         character(:), allocatable :: line, lines, text
         integer :: k

         lines = ''
         do c = 1, motions%count
            associate (q => motions%motions(c))
               if (q%flag == flag_none .or. is_explained(c)) cycle
               line = words_of_flag(q%flag, q%singularity, motions%polish)
               if (q%flag == flag_inconsistent) then
                  k = 0
                  if (allocated(q%diagnostics)) k = findloc(q%diagnostics%kind, diagnostic_surplus, dim=1)
                  if (k > 0) call write_folded(o, ' *** ', words_of(motions, q%diagnostics(k)))
                  ! A tolerance is no cure for a surplus drive.
                  table%surplus = table%surplus .or. k > 0
                  if (.not. (table%surplus .or. motions%closing > 0.0_wp)) &
                     line = line//': '//phrase(text_give_closing, motions%polish)
               else if (limits(c) < huge(1.0_wp)) then
                  line = phrase(text_beyond, motions%polish)//' '//time(motions, limits(c))
               else if (q%flag == flag_singular .and. any(q%singular_links%links /= 0)) then
                  k = index(line, ':')
                  text = links(motions, q%singular_links)
                  if (q%singular_links%in_line) text = text//' '//phrase(text_in_line, motions%polish)
                  line = line(:k - 1)//', '//text//line(k:)
               end if
            end associate
            if (index(lines, line//new_line('a')) > 0) cycle
            lines = lines//line//new_line('a')
            call write_folded(o, ' *** ', line)
         end do
      end subroutine write_marks
   end subroutine listing_instant

   !> Finds the time of the limit beyond which a motion has no position; huge if there is a position or another reason.
   pure real(wp) function limit_before(q) result(time)
      type(motion_t), intent(in) :: q        !< at an instant
      integer :: i

      time = huge(1.0_wp)
      if (q%flag /= flag_not_converged .or. .not. allocated(q%diagnostics)) return
      do i = 1, size(q%diagnostics)
         if (any(q%diagnostics(i)%kind == [diagnostic_limit, diagnostic_beyond])) time = q%diagnostics(i)%t
      end do
   end function limit_before

   !> Writes the line of the instants that wait for one; nothing if there are none.
   subroutine write_waiting(o, polish, table)
      type(output_t), intent(inout) :: o
      logical, intent(in) :: polish          !< in Polish
      type(listing_state_t), intent(inout) :: table   !< with the instants that wait; then none waits
      character(:), allocatable :: instants

      if (table%first < 0) return
      instants = phrase(text_instant, polish)//' '//whole(table%last)
      if (table%first < table%last) instants = phrase(text_instants, polish)//' '//whole(table%first)//' ' &
         //phrase(text_to, polish)//' '//whole(table%last)
      call put(o, '')
      call put(o, ' '//instants//': '//phrase(text_as, polish)//' '//whole(table%explained))
      table%kind = no_table
      table%first = -1
   end subroutine write_waiting

   !> Gives the reason why a motion is not complete in words: '' for flag_none.
   pure function words_of_flag(flag, singularity, polish) result(words)
      integer, intent(in) :: flag            !< flag_not_converged, ...
      integer, intent(in) :: singularity     !< with flag_singular: singular_change, ...
      logical, intent(in) :: polish          !< in Polish
      character(:), allocatable :: words

      words = phrase(flag_words(flag), polish)
      if (flag == flag_singular) words = phrase(singular_words(singularity), polish)
   end function words_of_flag

   !> Writes the last lines of a set: the closure error of redundant equations, and the error that a closing tolerance
   !> allows; diagnostics; the counts of certificates; the counts of solved and flagged instants.
   subroutine listing_end(o, set, solved, flagged, certificate_counts, closure_error, allowed_error, diagnostics)
      type(output_t), intent(inout) :: o
      class(set_t), intent(in) :: set        !< after its last instant
      integer, intent(in) :: solved, flagged   !< counts of instants
      type(certificate_counts_t), intent(in) :: certificate_counts   !< of all instants
      real(wp), intent(in) :: closure_error   !< characteristic lengths; below 0: no equation is redundant
      real(wp), intent(in) :: allowed_error   !< largest of instants with a position (characteristic lengths, rad); or 0
      type(diagnostic_t), intent(in) :: diagnostics(:)   !< (any number) after the last instant
      character(:), allocatable :: end_of
      character(20) :: number
      integer :: i

      call put(o, '')
      if (closure_error >= 0.0_wp) then
         write (number, '(es8.0e2)') max(closure_error, min_closure_error)
         number = adjustl(number)
         if (closure_error < min_closure_error) number = phrase(text_below, set%polish)//' '//number
         call put(o, ' '//phrase(text_closure_error, set%polish)//' '//trim(number))
      end if
      if (allowed_error > 0.0_wp) then
         write (number, '(es9.1e2)') allowed_error
         call write_folded(o, ' --- ', phrase(text_not_better, set%polish)//' '//trim(adjustl(number)))
      end if

      do i = 1, size(diagnostics)
         call write_diagnostics(o, set, diagnostics(i:i))
      end do
      associate (c => certificate_counts)
         call put(o, ' '//phrase(text_continuation, set%polish)//':  '//phrase(text_certified, set%polish)//' ' &
            //whole(c%followed)//' '//phrase(text_out_of, set%polish)//' '//whole(c%followed + c%uncertain) &
            //', '//phrase(text_passed, set%polish)//' '//whole(c%passed))
      end associate
      end_of = ' '//phrase(text_end, set%polish)//' '//whole(set%set_number)
      if (set%variant > 0) end_of = ' '//phrase(text_end_variant, set%polish)//' '//whole(set%variant)
      call put(o, end_of//':  '//phrase(text_instants, set%polish)//' '//phrase(text_are_solved, set%polish)//' ' &
         //whole(solved)//', '//phrase(text_flagged, set%polish)//' '//whole(flagged))
      call put(o, '')
   end subroutine listing_end

   !> Gives the text of a remark about a card: CARD 7  COLUMN 9: "TIP" and a sentence. A count of further remarks has
   !> neither card nor column.
   function remark_text(m, remark) result(text)
      type(mechanism_t), intent(in) :: m
      type(remark_t), intent(in) :: remark   !< about a card of the set
      character(:), allocatable :: text
      logical :: is_one

      text = trim(phrase(remark_words(remark%kind), m%polish)//' '//remark%value)
      if (remark%kind == remark_more) then
         text = text//' '//trim(remark%text)
         return
      end if
      if (any(remark%kind == [remark_rest, remark_turns])) then
         is_one = index(remark%text, ', ') == 0
         if (remark%kind == remark_rest .and. .not. is_one) text = phrase(text_rest, m%polish)
         text = phrase(merge(text_drive, text_drives, is_one), m%polish)//' '//trim(remark%text)//' '//text
      else if (remark%text /= '') then
         text = '"'//trim(remark%text)//'" '//text
      end if
      text = phrase(text_card, m%polish)//' '//whole(remark%card)//'  '//phrase(text_column, m%polish)//' ' &
         //whole(remark%column)//': '//text
   end function remark_text

   !> Writes a line for each diagnostic that no flag explains.
   subroutine write_diagnostics(o, set, list)
      type(output_t), intent(inout) :: o
      class(set_t), intent(in) :: set        !< of the diagnostics
      type(diagnostic_t), intent(in) :: list(:)   !< (any number)
      integer :: i

      do i = 1, size(list)
         if (all(list(i)%kind /= [diagnostic_beyond, diagnostic_surplus])) &
            call write_folded(o, merge(' *** ', ' --- ', any(list(i)%kind == of_results)), &
               words_of(set, list(i)))
      end do
   end subroutine write_diagnostics

   !> Gives the links or the cylinder of a limit in words: LINKS A, B AT THE LIMIT, COLLINEAR.
   function at_limit(set, diagnostic) result(text)
      class(set_t), intent(in) :: set        !< of the diagnostic
      type(diagnostic_t), intent(in) :: diagnostic   !< with links, or with the pair of a cylinder
      character(:), allocatable :: text

      if (diagnostic%pair > 0) then
         text = phrase(text_cylinder, set%polish)//' '//trim(name_in(set, diagnostic))//': ' &
            //phrase(merge(text_out_of_stroke, text_length_0, diagnostic%other), set%polish)
         return
      end if
      text = links(set, diagnostic)//' '//phrase(text_at_limit, set%polish)
      if (diagnostic%in_line) text = text//', '//phrase(text_in_line, set%polish)
   end function at_limit

   !> Gives the sentence of a diagnostic; '' for a kind that flags explain.
   function words_of(set, diagnostic) result(text)
      class(set_t), intent(in) :: set        !< of the diagnostic
      type(diagnostic_t), intent(in) :: diagnostic   !< of any kind
      character(:), allocatable :: text
      character(drive_length) :: drives(size(diagnostic%links))
      integer :: k

      text = ''
      select case (diagnostic%kind)
      case (diagnostic_inconsistent)
         text = owner()//': '//phrase(text_closure_error_of, set%polish)//' '//measure(set, diagnostic, error_digits)
      case (diagnostic_limit)
         text = phrase(text_drive, set%polish)//' '//name_of_drive(set, diagnostic%part, diagnostic%drive)//' = ' &
            //measure(set, diagnostic, value_digits)
         if (diagnostic%links(1) + diagnostic%pair > 0) text = text//', '//at_limit(set, diagnostic)
      case (diagnostic_stroke)
         text = phrase(text_cylinder, set%polish)//' '//trim(name_in(set, diagnostic))//': '
         if (diagnostic%value > 0.0_wp) &
            text = text//phrase(text_length, set%polish)//' '//measure(set, diagnostic, value_digits)
         if (.not. diagnostic%value > 0.0_wp) text = text//phrase(text_below_0, set%polish)

      case (diagnostic_far_estimate)
         text = links(set, diagnostic)//': '//phrase(text_off_by, set%polish)//' ' &
            //measure(set, diagnostic, error_digits)
      case (diagnostic_second)
         text = links(set, diagnostic)//': '//phrase(text_second, set%polish)
      case (diagnostic_incomplete)
         text = links(set, diagnostic)//': '//phrase(text_incomplete, set%polish)
      case (diagnostic_begins)
         text = phrase(text_begins, set%polish)

      case (diagnostic_redundant)
         text = phrase(text_redundant, set%polish)//': '//owner()
         if (diagnostic%equations > 1) text = phrase(text_redundant_many, set%polish)//': ' &
            //whole(diagnostic%equations)//' '//phrase(text_of_pair, set%polish)//' ' &
            //trim(name_in(set, diagnostic))
      case (diagnostic_change)
         text = place()//phrase(merge(merge(text_returns_other, text_returns, diagnostic%other), &
            merge(text_here, merge(text_other, text_smoothly, diagnostic%other), diagnostic%here), &
            diagnostic%returns), set%polish)
      case (diagnostic_dead_end)
         text = place()//phrase(text_not_found, set%polish)

      case (diagnostic_unused)
         text = 'BRANCH '
         if (diagnostic%links(1) > 0) &
            text = text//listed(link_names(set, diagnostic%part, diagnostic%links(:1)), set%polish)//' '
         text = text//phrase(text_branch_from, set%polish)//' '//time(set, diagnostic%t)//': ' &
            //phrase(text_no_change, set%polish)
      case (diagnostic_long)
         text = phrase(text_way, set%polish)//' '//time(set, diagnostic%t)//' '//phrase(text_too_long, set%polish)
      case (diagnostic_close)
         text = phrase(text_blocked, set%polish)//' '//time(set, diagnostic%t)//': '//phrase(text_close, set%polish)
      case (diagnostic_method)
         text = phrase(text_method, set%polish)
         if (diagnostic%other) text = phrase(text_elsewhere, set%polish)//': '//text

      case (diagnostic_surplus)
         do k = 1, count(diagnostic%links > 0)
            drives(k) = name_of_drive(set, diagnostic%part, diagnostic%links(k))
         end do
         text = phrase(text_surplus, set%polish)//' '//listed(drives(:k - 1), set%polish) &
            //more(diagnostic%more, set%polish)
      case (diagnostic_turned)
         text = 'LINE '//trim(name_in(set, diagnostic))//' ' &
            //phrase(text_turned_by, set%polish)//' '//measure(set, diagnostic, error_digits)//' ' &
            //phrase(text_in_step, set%polish)//' '//time(set, diagnostic%t)//': '//phrase(text_turned_far, set%polish)
      case (diagnostic_mobile)
         text = links(set, diagnostic)//' '//phrase(text_mobile, set%polish)
      end select

   contains

      !> Gives the words before a sentence about a change point: CHANGE POINT AT T = 16.000000 S, LINKS COUPLER,
      !> ROCKER, and a colon.
      function place() result(text)
         character(:), allocatable :: text

         text = phrase(merge(text_singular_at, text_change, diagnostic%returns), set%polish)//' ' &
            //time(set, diagnostic%t)//', '//links(set, diagnostic)//': '
      end function place

      !> Gives the owner of an equation: PAIR A, or DRIVE ANGLE B; '' if the diagnostic has neither.
      function owner() result(text)
         character(:), allocatable :: text

         text = ''
         if (diagnostic%pair > 0) then
            text = phrase(text_pair, set%polish)//' '//trim(name_in(set, diagnostic))
         else if (diagnostic%drive > 0) then
            text = phrase(text_drive, set%polish)//' '//name_of_drive(set, diagnostic%part, diagnostic%drive)
         end if
      end function owner
   end function words_of

   !> Gives the words for a full turn: TURNS FULLY, CLOSES AFTER 1 TURN.
   function full_turn_words(turns, polish) result(text)
      integer, intent(in) :: turns           !< turns after which the motion closes
      logical, intent(in) :: polish          !< in Polish
      character(:), allocatable :: text

      text = phrase(text_all, polish)//' '//whole(turns)//' '//phrase(merge(text_turn, text_turns, turns == 1), polish)
   end function full_turn_words

   !> Gives the links of a diagnostic: LINKS A, B AND 3 MORE.
   function links(set, diagnostic) result(text)
      class(set_t), intent(in) :: set        !< of the diagnostic
      type(diagnostic_t), intent(in) :: diagnostic   !< whose links are given
      character(:), allocatable :: text
      character(label_length), allocatable :: names(:)

      names = link_names(set, diagnostic%part, pack(diagnostic%links, diagnostic%links > 0))
      text = phrase(merge(text_link, text_links, size(names) == 1), set%polish)
      if (size(names) > 0) text = text//' '//listed(names, set%polish)
      text = text//more(diagnostic%more, set%polish)
   end function links

   !> Gives the value of a diagnostic with its unit.
   function measure(settings, diagnostic, digits) result(text)
      class(settings_t), intent(in) :: settings   !< of the set: the units
      type(diagnostic_t), intent(in) :: diagnostic   !< whose value is given
      integer, intent(in) :: digits          !< significant digits
      character(:), allocatable :: text
      !> Numbers between these have no exponent.
      real(wp), parameter :: min_without_exponent = 1.0e-4_wp, max_without_exponent = 1.0e9_wp

      if (diagnostic%is_angle) then
         text = rounded(diagnostic%value/merge(degree, 1.0_wp, settings%degrees), digits, min_without_exponent, &
            max_without_exponent)//' '//trim(angle_unit(settings))
      else
         text = rounded(diagnostic%value, digits, min_without_exponent, max_without_exponent)//' ' &
            //trim(settings%length_unit)
      end if
   end function measure

   !> Gives a time with the digits of the tables and its unit.
   function time(settings, t) result(text)
      class(settings_t), intent(in) :: settings   !< of the set: the instants and the unit
      real(wp), intent(in) :: t              !< time, in the deck's unit
      character(:), allocatable :: text
      type(format_t) :: f

      call choose_time_digits(settings, f)
      text = number_text(f, t, 0.0_wp)//' '//unit_of(f%power, trim(settings%time_unit))
   end function time
end module listing
